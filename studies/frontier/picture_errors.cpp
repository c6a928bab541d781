// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/picture_errors.h"

#include <cmath>

#include "core/error.h"
#include "studies/frontier/frontier_errors.h"

namespace glint {
namespace {

/// Mean over two sets of pixels.
class Squares {
 public:
  Squares(const ImageF& coverage, const Mask& region) : coverage_(coverage), region_(region) {}

  void add(std::size_t pixel, double square) {
    if (coverage_.values()[pixel] > 0.0F) {
      all_ += square;
      ++count_;
    }
    if (region_.values()[pixel] != 0) {
      smooth_ += square;
      ++smooth_count_;
    }
  }

  PictureDistance mean() const {
    return {
        .mean_square = all_ / static_cast<double>(std::max<std::int64_t>(1, count_)),
        .smooth_square = smooth_ / static_cast<double>(std::max<std::int64_t>(1, smooth_count_))};
  }

 private:
  const ImageF& coverage_;
  const Mask& region_;
  double all_ = 0.0;
  double smooth_ = 0.0;
  std::int64_t count_ = 0;
  std::int64_t smooth_count_ = 0;
};

/// A picture of larger pixels at full resolution.
ImageF at_full_resolution(ImageF picture, int reduction, int width_px, int height_px) {
  for (; reduction > 1; reduction /= 2) {
    picture = enlarged(picture,
                       reduction == 2 ? width_px : 2 * picture.width(),
                       reduction == 2 ? height_px : 2 * picture.height());
  }
  return picture;
}

}  // namespace

void ReferencePictures::add(const TracedScene& traced, const std::vector<ImageF>& frames) {
  if (pictures_ == 0) {
    coverage_ = traced.seen().coverage;
    region_ = traced.region.mask;
    sums_.assign(frames.size(), std::vector<double>(coverage_.size(), 0.0));
    squares_ = sums_;
  }
  GLINT_CHECK(frames.size() == sums_.size(), "all pictures have the same frames");
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (std::size_t i = 0; i < coverage_.size(); ++i) {
      const auto value = static_cast<double>(frames[k].values()[i]);
      sums_[k][i] += value;
      squares_[k][i] += value * value;
    }
  }
  ++pictures_;
  update_own();
}

void ReferencePictures::update_own() {
  if (pictures_ < 2) {
    return;
  }
  Squares squares(coverage_, region_);
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    for (std::size_t i = 0; i < coverage_.size(); ++i) {
      const double scatter = squares_[k][i] - sums_[k][i] * sums_[k][i] / pictures_;
      squares.add(i, std::max(0.0, scatter) / (pictures_ - 1.0) / pictures_);
    }
  }
  own_ = squares.mean();
}

double ReferencePictures::own_rmse() const {
  return std::sqrt(own_.mean_square);
}

PictureDistance ReferencePictures::distance(const std::vector<ImageF>& frames,
                                            int reduction) const {
  GLINT_CHECK(frames.size() == sums_.size(), "all pictures have the same frames");
  Squares squares(coverage_, region_);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const ImageF full =
        at_full_resolution(frames[k], reduction, coverage_.width(), coverage_.height());
    for (std::size_t i = 0; i < coverage_.size(); ++i) {
      const double error = static_cast<double>(full.values()[i]) - sums_[k][i] / pictures_;
      squares.add(i, error * error);
    }
  }
  return squares.mean();
}

ScoreError score_error(std::span<const double> values, const ReferenceScore& reference) {
  GLINT_CHECK(!values.empty(), "no value, no error");
  const auto count = static_cast<double>(values.size());
  ScoreError result;
  double mean_square = 0.0;
  for (const double value : values) {
    result.value += value / count;
    mean_square += (value - reference.value) * (value - reference.value) / count;
  }
  if (values.size() > 1) {
    double squares = 0.0;
    for (const double value : values) {
      squares += (value - result.value) * (value - result.value);
    }
    result.spread = std::sqrt(squares / (count - 1.0));
  }
  result.error = rms_less_noise(mean_square, reference.standard_error * reference.standard_error);
  return result;
}

}  // namespace glint

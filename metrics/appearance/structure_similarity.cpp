// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/appearance/structure_similarity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "metrics/appearance/ssim_kernels.h"

namespace glint {
namespace {

using ssim_kernels::kTaps;

constexpr int kHalf = kTaps / 2;

void check_sizes(const ImageF& first, const ImageF& second, const Mask& region) {
  const bool has_region = !region.empty();
  if (first.width() != second.width() || first.height() != second.height() || first.empty() ||
      (has_region && (region.width() != first.width() || region.height() != first.height()))) {
    throw ConfigError(fmt::format("appearance: pictures of {} x {} and {} x {} pixels",
                                  first.width(),
                                  first.height(),
                                  second.width(),
                                  second.height()));
  }
}

std::array<float, kTaps> gaussian_weights() {
  constexpr double kSigmaPx = 1.5;
  std::array<double, kTaps> weights = {};
  double sum = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    const double at = (i - kHalf) / kSigmaPx;
    weights[static_cast<std::size_t>(i)] = std::exp(-0.5 * at * at);
    sum += weights[static_cast<std::size_t>(i)];
  }
  std::array<float, kTaps> shares = {};
  std::ranges::transform(
      weights, shares.begin(), [&](double weight) { return static_cast<float>(weight / sum); });
  return shares;
}

/// Mirrored at the outermost pixels, which are not repeated.
int mirrored(int i, int count) {
  if (count == 1) {
    return 0;
  }
  const int period = 2 * (count - 1);
  const int at = ((i % period) + period) % period;
  return at < count ? at : period - at;
}

/// One row of the five sums, with kHalf mirrored values at both ends.
class PaddedSums {
 public:
  explicit PaddedSums(int width) : width_(width) {
    for (std::vector<float>& row : rows_) {
      row.resize(static_cast<std::size_t>(width + kTaps - 1));
    }
  }

  ssim_kernels::Sums inner() {
    return {.a = rows_[0].data() + kHalf,
            .b = rows_[1].data() + kHalf,
            .aa = rows_[2].data() + kHalf,
            .bb = rows_[3].data() + kHalf,
            .ab = rows_[4].data() + kHalf};
  }

  void mirror() {
    for (std::vector<float>& row : rows_) {
      float* values = row.data() + kHalf;
      for (int i = 1; i <= kHalf; ++i) {
        values[-i] = values[mirrored(-i, width_)];
        values[width_ - 1 + i] = values[mirrored(width_ - 1 + i, width_)];
      }
    }
  }

  const std::array<std::vector<float>, 5>& rows() const { return rows_; }

 private:
  int width_;
  std::array<std::vector<float>, 5> rows_;
};

/// Means of 2 x 2 pixels; a last odd row or column is left out.
ImageF halved(const ImageF& picture) {
  ImageF half(picture.width() / 2, picture.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    const float* upper = picture.row(2 * y);
    const float* lower = picture.row(2 * y + 1);
    for (int x = 0; x < half.width(); ++x) {
      half(x, y) = 0.25F * (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
    }
  }
  return half;
}

/// Magnitude of the Prewitt gradient (weights 1/3), nearest values beyond the border.
ImageF gradient_of(const ImageF& picture) {
  ImageF gradient(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y) {
    const float* up = picture.row(std::max(y - 1, 0));
    const float* here = picture.row(y);
    const float* down = picture.row(std::min(y + 1, picture.height() - 1));
    for (int x = 0; x < picture.width(); ++x) {
      const int left = std::max(x - 1, 0);
      const int right = std::min(x + 1, picture.width() - 1);
      const float dx = up[right] + here[right] + down[right] - up[left] - here[left] - down[left];
      const float dy = down[left] + down[x] + down[right] - up[left] - up[x] - up[right];
      gradient(x, y) = std::sqrt(dx * dx + dy * dy) / 3.0F;
    }
  }
  return gradient;
}

bool is_whole_in(const Mask& region, int x, int y) {
  return region.empty() || (region(2 * x, 2 * y) != 0 && region(2 * x + 1, 2 * y) != 0 &&
                            region(2 * x, 2 * y + 1) != 0 && region(2 * x + 1, 2 * y + 1) != 0);
}

}  // namespace

ImageF ssim_map(const ImageF& first, const ImageF& second, double range) {
  check_sizes(first, second, {});
  const std::array<float, kTaps> weights = gaussian_weights();
  const auto c1 = static_cast<float>(0.01 * 0.01 * range * range);
  const auto c2 = static_cast<float>(0.03 * 0.03 * range * range);
  const int width = first.width();
  ImageF map = ImageF::uninitialized(width, first.height());
  PaddedSums sums(width);
  std::array<std::vector<float>, 5> means;
  std::ranges::fill(means, std::vector<float>(static_cast<std::size_t>(width)));
  std::array<const float*, kTaps> rows_a = {};
  std::array<const float*, kTaps> rows_b = {};
  for (int y = 0; y < first.height(); ++y) {
    for (int k = 0; k < kTaps; ++k) {
      const int from = mirrored(y + k - kHalf, first.height());
      rows_a[static_cast<std::size_t>(k)] = first.row(from);
      rows_b[static_cast<std::size_t>(k)] = second.row(from);
    }
    ssim_kernels::sum_rows(rows_a.data(), rows_b.data(), weights.data(), width, sums.inner());
    sums.mirror();
    for (std::size_t i = 0; i < means.size(); ++i) {
      ssim_kernels::sum_columns(sums.rows()[i].data(), weights.data(), width, means[i].data());
    }
    ssim_kernels::compare({.a = means[0].data(),
                           .b = means[1].data(),
                           .aa = means[2].data(),
                           .bb = means[3].data(),
                           .ab = means[4].data()},
                          c1,
                          c2,
                          width,
                          map.row(y));
  }
  return map;
}

double mean_in(const ImageF& map, const Mask& region) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (region.empty() || region.values()[i] != 0) {
      sum += static_cast<double>(map.values()[i]);
      count += 1.0;
    }
  }
  return count > 0.0 ? sum / count : 1.0;
}

double ssim(const ImageF& first, const ImageF& second, const Mask& region, double range) {
  check_sizes(first, second, region);
  return mean_in(ssim_map(first, second, range), region);
}

double gmsd(const ImageF& first, const ImageF& second, const Mask& region, double range) {
  check_sizes(first, second, region);
  return deviation_in(gradient_similarity_map(first, second, range), region);
}

ImageF gradient_similarity_map(const ImageF& first, const ImageF& second, double range) {
  check_sizes(first, second, {});
  const ImageF a = gradient_of(halved(first));
  const ImageF b = gradient_of(halved(second));
  const double t = 170.0 / (255.0 * 255.0) * range * range;
  ImageF map(a.width(), a.height());
  std::ranges::transform(
      a.values(), b.values(), map.values().begin(), [&](float of_first, float of_second) {
        const auto p = static_cast<double>(of_first);
        const auto q = static_cast<double>(of_second);
        return static_cast<float>((2.0 * p * q + t) / (p * p + q * q + t));
      });
  return map;
}

double deviation_in(const ImageF& map, const Mask& region) {
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      if (is_whole_in(region, x, y)) {
        const auto alike = static_cast<double>(map(x, y));
        count += 1.0;
        sum += alike;
        squares += alike * alike;
      }
    }
  }
  return count > 0.0 ? std::sqrt(std::max(squares / count - sum * sum / (count * count), 0.0))
                     : 0.0;
}

}  // namespace glint

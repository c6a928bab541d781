// SPDX-License-Identifier: GPL-3.0-or-later
//
// Robust noise of a response: 1.4826 times the median distance from the median. Each median takes
// one sweep: a sample of every 127th pixel brackets it, the sweep counts what lies below and keeps
// what lies within, and only that is selected from. A wrong bracket costs a second sweep, not
// correctness. docs/theory/inspection.md, "Threshold". Cost: two sweeps over the region; memory for
// a few per cent of its values.
#include "metrics/inspection/response_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "metrics/inspection/filter_kernels.h"

namespace glint {
namespace {

using inspection_kernels::Reading;

/// 1 / the 75 % point of the standard normal distribution.
constexpr double kSigmaOfMedian = 1.4826022185056018;

float reading_of(float value, Reading reading) {
  const float difference = value - reading.middle;
  return reading.is_distance ? std::abs(difference) : difference;
}

/// Finds medians in one sweep: a sample brackets the median, so that few values must be sorted. A
/// wrong bracket only costs time.
class MedianFinder {
 public:
  /// @param pool  null: on the calling thread
  MedianFinder(const ImageF& image, const Spans& spans, ThreadPool* pool)
      : image_(image), spans_(spans), pool_(pool) {
    for (const RowSpan& span : spans) {
      pixels_ += span.size();
    }
    GLINT_CHECK(pixels_ > 0, "the region has no pixel");
  }

  float median(Reading reading) const {
    const std::int64_t rank = (pixels_ - 1) / 2;
    const auto [low, high] = bracket(reading);
    const std::vector<Part> parts = split(reading, low, high);
    std::int64_t below = 0;
    std::vector<float> within;
    for (const Part& part : parts) {
      below += part.below;
      within.insert(within.end(), part.within.begin(), part.within.end());
    }
    if (rank < below || rank >= below + static_cast<std::int64_t>(within.size())) {
      return select(all(reading), rank);
    }
    return select(std::move(within), rank - below);
  }

 private:
  static constexpr std::size_t kSpansPerPart = 32;

  struct Part {
    std::int64_t below = 0;
    std::vector<float> within;
  };

  struct Bracket {
    float low = 0.0F;
    float high = 0.0F;
  };

  static float select(std::vector<float> values, std::int64_t rank) {
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  }

  /// Of every 127th value, those four standard deviations of a sample's median to either side.
  Bracket bracket(Reading reading) const {
    constexpr int kEvery = 127;  // no divisor of usual widths
    std::vector<float> sample;
    int next = 0;
    for (const RowSpan& span : spans_) {
      for (; next < span.size(); next += kEvery) {
        sample.push_back(reading_of(image_.row(span.y)[span.begin + next], reading));
      }
      next -= span.size();
    }
    const auto count = static_cast<std::int64_t>(sample.size());
    const auto spread = static_cast<std::int64_t>(2.0 * std::sqrt(static_cast<double>(count))) + 2;
    const std::int64_t low = std::max<std::int64_t>(0, count / 2 - spread);
    const std::int64_t high = std::min(count - 1, count / 2 + spread);
    const auto lower = sample.begin() + static_cast<std::ptrdiff_t>(low);
    const auto upper = sample.begin() + static_cast<std::ptrdiff_t>(high);
    std::nth_element(sample.begin(), lower, sample.end());
    const float minimum = *lower;
    std::nth_element(lower, upper, sample.end());
    return {minimum, *upper};
  }

  Part part_of(std::size_t part_index, Reading reading, float low, float high) const {
    const std::size_t first = part_index * kSpansPerPart;
    Part part;
    std::vector<float> kept(static_cast<std::size_t>(image_.width()));
    for (std::size_t s = first; s < std::min(first + kSpansPerPart, spans_.size()); ++s) {
      const RowSpan& span = spans_[s];
      const auto [below, within] = inspection_kernels::split_readings(
          image_.row(span.y) + span.begin, span.size(), reading, low, high, kept.data());
      part.below += below;
      part.within.insert(part.within.end(), kept.begin(), kept.begin() + within);
    }
    return part;
  }

  std::vector<Part> split(Reading reading, float low, float high) const {
    const std::size_t count = (spans_.size() + kSpansPerPart - 1) / kSpansPerPart;
    if (pool_ != nullptr) {
      return pool_->map<Part>(static_cast<std::int64_t>(count), [&](std::int64_t i) {
        return part_of(static_cast<std::size_t>(i), reading, low, high);
      });
    }
    std::vector<Part> parts;
    for (std::size_t i = 0; i < count; ++i) {
      parts.push_back(part_of(i, reading, low, high));
    }
    return parts;
  }

  std::vector<float> all(Reading reading) const {
    std::vector<float> readings;
    for (const RowSpan& span : spans_) {
      for (int x = span.begin; x < span.end; ++x) {
        readings.push_back(reading_of(image_(x, span.y), reading));
      }
    }
    return readings;
  }

  const ImageF& image_;
  const Spans& spans_;
  ThreadPool* pool_;
  std::int64_t pixels_ = 0;
};

double deviation_of(const MedianFinder& finder) {
  const float middle = finder.median({});
  const float distance = finder.median({.middle = middle, .is_distance = true});
  return kSigmaOfMedian * static_cast<double>(distance);
}

}  // namespace

double robust_deviation(const ImageF& image, const Spans& spans, ThreadPool& pool) {
  return deviation_of(MedianFinder(image, spans, &pool));
}

double robust_deviation(const ImageF& image, const Spans& spans) {
  return deviation_of(MedianFinder(image, spans, nullptr));
}

double robust_size(const ImageF& image, const Spans& spans) {
  const MedianFinder finder(image, spans, nullptr);
  return kSigmaOfMedian * static_cast<double>(finder.median({.is_distance = true}));
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Homogeneity of the mean image: mean, rms and absolute deviation in two sweeps over the region,
// with 32 independent partial sums so that the loops vectorise and give the same bits on any
// machine. Percentiles need no sorting: a sample brackets each of them, one sweep counts what lies
// beside the bracket and keeps what lies inside, and only that is selected from. A wrong bracket
// costs time, not correctness. Formulas: docs/theory/homogeneity.md. Cost: linear in the region;
// memory for a few per cent of its values, where percentiles are asked for.
#include "metrics/aspect_image/homogeneity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/image/spans.h"
#include "core/simd.h"

namespace glint {
namespace {

/// Sums go over so many lanes: independent additions, and the same bits on any machine.
constexpr std::size_t kLanes = 32;

double total_of(const std::array<double, kLanes>& lanes) {
  double sum = 0.0;
  for (const double lane : lanes) {
    sum += lane;
  }
  return sum;
}

void check_region(const ImageF& image, const Region& region) {
  GLINT_CHECK(image.width() == region.mask.width() && image.height() == region.mask.height(),
              "image and region differ in size");
  GLINT_CHECK(!region.spans.empty(), "the region has no pixel");
}

const float* start_of(const ImageF& image, const RowSpan& span) {
  return image.row(span.y) + span.begin;
}

/// Counts of values at or below `low`, and below `high`.
struct Split {
  std::int64_t to_low = 0;
  std::int64_t below_high = 0;

  bool has_between() const { return below_high > to_low; }

  void add(const Split& other) {
    to_low += other.to_low;
    below_high += other.below_high;
  }
};

/// Two values between which a rank almost surely lies.
struct Bracket {
  float low = 0.0F;
  float high = 0.0F;
};

GLINT_WIDE Split split_by(const float* values, int count, Bracket bracket) {
  int to_low = 0;
  int below_high = 0;
  for (int i = 0; i < count; ++i) {
    to_low += values[i] <= bracket.low ? 1 : 0;
    below_high += values[i] < bracket.high ? 1 : 0;
  }
  return {.to_low = to_low, .below_high = below_high};
}

/// Index of the value that has at least this share of `count` at or below it.
std::int64_t rank_of(double share, std::int64_t count) {
  const double wanted = std::ceil(share * static_cast<double>(count));
  return static_cast<std::int64_t>(std::max(wanted, 1.0)) - 1;
}

/// Every so many-th value of the region.
std::vector<float> sample_of(const ImageF& image, const Spans& stretches) {
  constexpr int kEvery = 127;  // no divisor of usual widths
  std::vector<float> sample;
  int next = 0;
  for (const RowSpan& block : stretches) {
    const float* values = start_of(image, block);
    for (; next < block.size(); next += kEvery) {
      sample.push_back(values[next]);
    }
    next -= block.size();
  }
  return sample;
}

/// Of a sample, the values four standard deviations of such a guess to either side of the share.
Bracket bracket_of(std::vector<float>& sample, double share) {
  const auto count = static_cast<double>(sample.size());
  const double middle = share * count;
  const double spread = 4.0 * std::sqrt(share * (1.0 - share) * count) + 2.0;
  const auto at = [&](double place) {
    const auto nth =
        sample.begin() + static_cast<std::ptrdiff_t>(std::clamp(place, 0.0, count - 1.0));
    std::nth_element(sample.begin(), nth, sample.end());
    return *nth;
  };
  return {.low = at(middle - spread), .high = at(middle + spread)};
}

double select_rank(std::vector<float> values, std::int64_t rank) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), nth, values.end());
  return static_cast<double>(*nth);
}

/// Finds the value of a rank in one sweep: counts what lies beside a bracket and keeps what lies in
/// it. A wrong bracket only costs time.
class Percentile {
 public:
  Percentile(std::vector<float>& sample, double share)
      : share_(share), bracket_(bracket_of(sample, share)) {}

  void add(const float* values, int count) {
    const Split split = split_by(values, count, bracket_);
    split_.add(split);
    if (split.has_between()) {
      keep_between(values, count, split);
    }
  }

  double value(const ImageF& image, const Spans& stretches, std::int64_t count) const {
    const std::int64_t rank = rank_of(share_, count);
    if (rank >= split_.to_low && rank < split_.below_high) {
      return select_rank(between_, rank - split_.to_low);
    }
    std::vector<float> all;
    for (const RowSpan& block : stretches) {
      all.insert(all.end(), start_of(image, block), start_of(image, block) + block.size());
    }
    const auto is_at = [&](float value) {
      const auto minimum = std::ranges::count_if(all, [&](float v) { return v < value; });
      return minimum <= rank && rank < minimum + std::ranges::count(all, value);
    };
    for (const float end : {bracket_.low, bracket_.high}) {
      if (is_at(end)) {
        return static_cast<double>(end);
      }
    }
    return select_rank(std::move(all), rank);
  }

 private:
  void keep_between(const float* values, int count, const Split& split) {
    const std::size_t kept = between_.size();
    between_.resize(kept + static_cast<std::size_t>(count));
    float* to = between_.data() + kept;
    for (int i = 0; i < count; ++i) {
      *to = values[i];
      const bool is_kept = (values[i] > bracket_.low) & (values[i] < bracket_.high);
      to += is_kept ? 1 : 0;
    }
    between_.resize(kept + static_cast<std::size_t>(split.below_high - split.to_low));
  }

  double share_;
  Bracket bracket_;
  Split split_;
  std::vector<float> between_;
};

/// The mean of the region's pixels in the 3 x 3 square around a pixel of the region.
double local_mean(const ImageF& image, const Mask& region, int x, int y) {
  double sum = 0.0;
  double count = 0.0;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, image.height() - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, image.width() - 1); ++u) {
      if (region(u, v) != 0) {
        sum += static_cast<double>(image(u, v));
        count += 1.0;
      }
    }
  }
  return sum / count;
}

/// In float: the largest value that is not above a threshold.
float largest_to(double threshold) {
  const auto largest = static_cast<float>(threshold);
  return static_cast<double>(largest) > threshold
             ? std::nextafter(largest, -std::numeric_limits<float>::infinity())
             : largest;
}

/// What one sweep tells of values.
struct Levels {
  double sum = 0.0;
  Split split;
};

/// Sum, and counts beside a bracket.
GLINT_WIDE Levels levels_of(const float* values, std::size_t count, Bracket bracket) {
  std::array<double, kLanes> lanes = {};
  const std::size_t whole = count - count % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      lanes[lane] += static_cast<double>(values[i + lane]);
    }
  }
  for (std::size_t i = whole; i < count; ++i) {
    lanes[0] += static_cast<double>(values[i]);
  }
  int to_low = 0;
  int below_high = 0;
  for (std::size_t i = 0; i < count; ++i) {
    to_low += values[i] <= bracket.low ? 1 : 0;
    below_high += values[i] < bracket.high ? 1 : 0;
  }
  return {.sum = total_of(lanes), .split = {.to_low = to_low, .below_high = below_high}};
}

struct Deviations {
  double squares = 0.0;
  double absolute = 0.0;
};

/// Sums of squares and sizes of the deviations from the mean.
GLINT_WIDE Deviations deviations_from(double mean, const float* values, std::size_t count) {
  std::array<double, kLanes> squares = {};
  std::array<double, kLanes> absolute = {};
  const std::size_t whole = count - count % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double deviation = static_cast<double>(values[i + lane]) - mean;
      squares[lane] += deviation * deviation;
      absolute[lane] += std::abs(deviation);
    }
  }
  for (std::size_t i = whole; i < count; ++i) {
    const double deviation = static_cast<double>(values[i]) - mean;
    squares[0] += deviation * deviation;
    absolute[0] += std::abs(deviation);
  }
  return {.squares = total_of(squares), .absolute = total_of(absolute)};
}

std::int64_t pixels_of(const Spans& spans) {
  std::int64_t pixels = 0;
  for (const RowSpan& span : spans) {
    pixels += span.size();
  }
  return pixels;
}

GLINT_WIDE int count_from(const std::uint16_t* values, int count, int minimum) {
  int found = 0;
  for (int i = 0; i < count; ++i) {
    found += static_cast<int>(values[i]) >= minimum ? 1 : 0;
  }
  return found;
}

double saturated_share(const Image<std::uint16_t>& clipped_frames,
                       int frames,
                       const Spans& stretches,
                       std::int64_t pixels) {
  std::int64_t saturated = 0;
  for (const RowSpan& span : stretches) {
    saturated += count_from(clipped_frames.row(span.y) + span.begin, span.size(), frames);
  }
  return static_cast<double>(saturated) / static_cast<double>(pixels);
}

/// In one more sweep over the region.
double percentile_uniformity(const ImageF& aspect, const Spans& stretches, std::int64_t pixels) {
  std::vector<float> sample = sample_of(aspect, stretches);
  Percentile p5(sample, 0.05);
  Percentile p95(sample, 0.95);
  for (const RowSpan& span : stretches) {
    p5.add(start_of(aspect, span), span.size());
    p95.add(start_of(aspect, span), span.size());
  }
  const double low = p5.value(aspect, stretches, pixels);
  const double high = p95.value(aspect, stretches, pixels);
  return high > 0.0 ? 1.0 - (high - low) / (high + low) : 0.0;
}

Levels levels_of(const ImageF& image, const Spans& stretches, Bracket bracket) {
  Levels total;
  for (const RowSpan& span : stretches) {
    const Levels part =
        levels_of(start_of(image, span), static_cast<std::size_t>(span.size()), bracket);
    total.sum += part.sum;
    total.split.add(part.split);
  }
  return total;
}

Deviations deviations_from(double mean, const ImageF& image, const Spans& stretches) {
  Deviations total;
  for (const RowSpan& span : stretches) {
    const Deviations part =
        deviations_from(mean, start_of(image, span), static_cast<std::size_t>(span.size()));
    total.squares += part.squares;
    total.absolute += part.absolute;
  }
  return total;
}

/// From when a pixel counts as lit, and from when as full.
Bracket lit_and_full(const MetricsSettings& settings) {
  constexpr double kBelowFullScale = 1.0 - 1e-6;
  return {
      .low = largest_to(settings.lit_threshold),
      .high = std::nextafter(largest_to(kBelowFullScale), std::numeric_limits<float>::infinity())};
}

}  // namespace

Homogeneity homogeneity(const ImageF& aspect,
                        const Image<std::uint16_t>& clipped_frames,
                        int frames,
                        const Region& region,
                        const MetricsSettings& settings,
                        bool wants_robust) {
  check_region(aspect, region);
  const Spans& stretches = region.spans;
  const std::int64_t pixels = pixels_of(stretches);
  const auto count = static_cast<double>(pixels);
  const Levels levels = levels_of(aspect, stretches, lit_and_full(settings));
  Homogeneity result;
  result.mean = levels.sum / count;
  result.lit_share = static_cast<double>(pixels - levels.split.to_low) / count;
  result.clipped_share = clipped_frames.empty()
                             ? static_cast<double>(pixels - levels.split.below_high) / count
                             : saturated_share(clipped_frames, frames, stretches, pixels);
  if (!(result.mean > 0.0)) {
    result.h_rms = -std::sqrt(count);
    result.h_abs = -1.0;
    if (wants_robust) {
      result.robust = 0.0;
    }
    return result;
  }
  const Deviations total = deviations_from(result.mean, aspect, stretches);
  result.h_rms = 1.0 - std::sqrt(total.squares / count) / result.mean;
  result.h_abs = 1.0 - total.absolute / count / result.mean;
  if (wants_robust) {
    result.robust = percentile_uniformity(aspect, stretches, pixels);
  }
  return result;
}

double smallest_over_mean(const ImageF& aspect, const Mask& region) {
  const Spans stretches = spans_of(region);
  GLINT_CHECK(!stretches.empty(), "the region has no pixel");
  const double mean =
      levels_of(aspect, stretches, {}).sum / static_cast<double>(pixels_of(stretches));
  double smallest = mean;
  for (int y = 0; y < aspect.height(); ++y) {
    for (int x = 0; x < aspect.width(); ++x) {
      if (region(x, y) != 0) {
        smallest = std::min(smallest, local_mean(aspect, region, x, y));
      }
    }
  }
  return mean > 0.0 ? smallest / mean : 0.0;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/homogeneity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#define GLINT_WIDE __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))

namespace glint {
namespace {

/// Sums go over eight lanes: independent additions, and the same bits on any machine.
constexpr std::size_t kLanes = 8;

double total_of(const std::array<double, kLanes>& lanes) {
  double sum = 0.0;
  for (const double lane : lanes) {
    sum += lane;
  }
  return sum;
}

/// Pixels of a region mostly stand together: they are looked at eight at a time.
std::vector<float> values_inside(const ImageF& image, const Mask& region) {
  GLINT_CHECK(image.width() == region.width() && image.height() == region.height(),
              "image and region differ in size");
  constexpr std::uint64_t kAll = 0x0101010101010101;
  std::vector<float> values(image.size());
  const float* from = image.values().data();
  const unsigned char* inside = region.values().data();
  float* to = values.data();
  const std::size_t size = image.size();
  for (std::size_t i = 0; i < size; i += sizeof(kAll)) {
    const std::size_t count = std::min(sizeof(kAll), size - i);
    std::uint64_t eight = 0;
    std::memcpy(&eight, inside + i, count);
    if (eight == kAll) {
      std::memcpy(to, from + i, sizeof(kAll) * sizeof(float));
      to += sizeof(kAll);
      continue;
    }
    for (std::size_t k = i; eight != 0 && k < i + count; ++k) {
      *to = from[k];
      to += inside[k] != 0 ? 1 : 0;
    }
  }
  values.resize(static_cast<std::size_t>(to - values.data()));
  GLINT_CHECK(!values.empty(), "the region has no pixel");
  return values;
}

/// How many of `count` values are at or below low, and below high.
struct Split {
  int to_low = 0;
  int below_high = 0;
};

GLINT_WIDE Split split_by(const float* values, int count, float low, float high) {
  Split split;
  for (int i = 0; i < count; ++i) {
    split.to_low += values[i] <= low ? 1 : 0;
    split.below_high += values[i] < high ? 1 : 0;
  }
  return split;
}

/// Index of the value that has at least this share of `count` at or below it.
std::size_t rank_of(double share, std::size_t count) {
  const double wanted = std::ceil(share * static_cast<double>(count));
  return static_cast<std::size_t>(std::max(wanted, 1.0)) - 1;
}

struct Bracket {
  float low = 0.0F;
  float high = 0.0F;
};

/// Two values between which that rank almost surely lies: of every so many-th value (sorted), those
/// four standard deviations of such a guess to either side.
Bracket bracket_of(const std::vector<float>& sample, double share) {
  const auto count = static_cast<double>(sample.size());
  const double middle = share * count;
  const double spread = 4.0 * std::sqrt(share * (1.0 - share) * count) + 2.0;
  const auto at = [&](double place) {
    return sample[static_cast<std::size_t>(std::clamp(place, 0.0, count - 1.0))];
  };
  return {.low = at(middle - spread), .high = at(middle + spread)};
}

double select_rank(std::vector<float> values, std::size_t rank) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), nth, values.end());
  return static_cast<double>(*nth);
}

/// The value of that rank. One sweep counts what lies beside a bracket guessed from a sample and
/// keeps what lies in it; a wrong guess only costs time.
double percentile(const std::vector<float>& values,
                  const std::vector<float>& sorted_sample,
                  double share) {
  constexpr std::size_t kBlock = 256;
  const std::size_t rank = rank_of(share, values.size());
  const Bracket bracket = bracket_of(sorted_sample, share);
  std::size_t to_low = 0;
  std::size_t below_high = 0;
  std::vector<float> between;
  for (std::size_t i = 0; i < values.size(); i += kBlock) {
    const std::size_t end = std::min(values.size(), i + kBlock);
    const Split split =
        split_by(values.data() + i, static_cast<int>(end - i), bracket.low, bracket.high);
    to_low += static_cast<std::size_t>(split.to_low);
    below_high += static_cast<std::size_t>(split.below_high);
    if (split.below_high > split.to_low) {
      std::copy_if(
          values.data() + i, values.data() + end, std::back_inserter(between), [&](float value) {
            return value > bracket.low && value < bracket.high;
          });
    }
  }
  if (rank >= to_low && rank < below_high) {
    return select_rank(std::move(between), rank - to_low);
  }
  const auto times = [&](float value) {
    return static_cast<std::size_t>(std::ranges::count(values, value));
  };
  if (rank < to_low && rank + times(bracket.low) >= to_low) {
    return static_cast<double>(bracket.low);
  }
  if (rank >= below_high && rank < below_high + times(bracket.high)) {
    return static_cast<double>(bracket.high);
  }
  return select_rank(values, rank);
}

std::vector<float> sorted_sample(const std::vector<float>& values) {
  constexpr std::size_t kEvery = 127;  // no divisor of usual widths
  std::vector<float> sample;
  for (std::size_t i = 0; i < values.size(); i += kEvery) {
    sample.push_back(values[i]);
  }
  std::ranges::sort(sample);
  return sample;
}

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

double share_above(const std::vector<float>& values, double threshold) {
  // In float: the largest value that is not above.
  auto largest = static_cast<float>(threshold);
  if (static_cast<double>(largest) > threshold) {
    largest = std::nextafter(largest, -std::numeric_limits<float>::infinity());
  }
  const Split split = split_by(values.data(), static_cast<int>(values.size()), largest, largest);
  const auto above = values.size() - static_cast<std::size_t>(split.to_low);
  return static_cast<double>(above) / static_cast<double>(values.size());
}

struct Deviations {
  double mean = 0.0;
  double rms = 0.0;
  double absolute = 0.0;
};

GLINT_WIDE double sum_of(const float* values, std::size_t count) {
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
  return total_of(lanes);
}

/// Sums of squares and sizes of the deviations from the mean.
GLINT_WIDE void add_deviations(const float* values, std::size_t count, Deviations& result) {
  const double mean = result.mean;
  std::array<double, kLanes> squares = {};
  std::array<double, kLanes> sizes = {};
  const std::size_t whole = count - count % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double deviation = static_cast<double>(values[i + lane]) - mean;
      squares[lane] += deviation * deviation;
      sizes[lane] += deviation < 0.0 ? -deviation : deviation;
    }
  }
  for (std::size_t i = whole; i < count; ++i) {
    const double deviation = static_cast<double>(values[i]) - mean;
    squares[0] += deviation * deviation;
    sizes[0] += std::abs(deviation);
  }
  result.rms = total_of(squares);
  result.absolute = total_of(sizes);
}

Deviations deviations_of(const std::vector<float>& values) {
  const auto count = static_cast<double>(values.size());
  Deviations result;
  result.mean = sum_of(values.data(), values.size()) / count;
  add_deviations(values.data(), values.size(), result);
  result.rms = std::sqrt(result.rms / count);
  result.absolute /= count;
  return result;
}

struct BlindCount {
  unsigned inside = 0;
  unsigned blind = 0;
};

GLINT_WIDE BlindCount count_blind(const std::uint16_t* clipped_frames,
                                  const unsigned char* region,
                                  std::size_t size,
                                  int frames) {
  BlindCount count;
  for (std::size_t i = 0; i < size; ++i) {
    const unsigned is_inside = region[i] != 0 ? 1U : 0U;
    const unsigned is_blind = static_cast<int>(clipped_frames[i]) >= frames ? 1U : 0U;
    count.inside += is_inside;
    count.blind += is_inside & is_blind;
  }
  return count;
}

}  // namespace

Homogeneity homogeneity(const ImageF& aspect,
                        const Image<std::uint16_t>& clipped_frames,
                        int frames,
                        const Mask& region,
                        const MetricsSettings& settings) {
  const std::vector<float> values = values_inside(aspect, region);
  const Deviations spread = deviations_of(values);
  Homogeneity result;
  result.mean = spread.mean;
  result.lit_share = share_above(values, settings.lit_threshold);
  constexpr double kBelowFullScale = 1.0 - 1e-6;
  result.clipped_share = clipped_frames.empty()
                             ? share_above(values, kBelowFullScale)
                             : always_clipped_share(clipped_frames, frames, region);
  if (!(spread.mean > 0.0)) {
    result.h_rms = -std::sqrt(static_cast<double>(values.size()));
    result.h_abs = -1.0;
    return result;
  }
  result.h_rms = 1.0 - spread.rms / spread.mean;
  result.h_abs = 1.0 - spread.absolute / spread.mean;
  const std::vector<float> sample = sorted_sample(values);
  const double p5 = percentile(values, sample, 0.05);
  const double p95 = percentile(values, sample, 0.95);
  result.robust = p95 > 0.0 ? 1.0 - (p95 - p5) / (p95 + p5) : 0.0;
  return result;
}

double always_clipped_share(const Image<std::uint16_t>& clipped_frames,
                            int frames,
                            const Mask& region) {
  GLINT_CHECK(clipped_frames.size() == region.size(), "counts and region differ in size");
  const auto [inside, blind] =
      count_blind(clipped_frames.values().data(), region.values().data(), region.size(), frames);
  GLINT_CHECK(inside > 0, "the region has no pixel");
  return static_cast<double>(blind) / static_cast<double>(inside);
}

double smallest_over_mean(const ImageF& aspect, const Mask& region) {
  const double mean = deviations_of(values_inside(aspect, region)).mean;
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

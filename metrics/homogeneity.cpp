// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/homogeneity.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace glint {
namespace {

std::vector<float> values_inside(const ImageF& image, const Mask& region) {
  GLINT_CHECK(image.width() == region.width() && image.height() == region.height(),
              "image and region differ in size");
  std::vector<float> values;
  values.reserve(image.size());
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (region.values()[i] != 0) {
      values.push_back(image.values()[i]);
    }
  }
  GLINT_CHECK(!values.empty(), "the region has no pixel");
  return values;
}

/// The smallest value with at least this share of the values at or below it. Values are counted in
/// classes first, so that only one class has to be sorted.
double percentile(const std::vector<float>& values, double share) {
  constexpr std::size_t kClasses = 4096;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const float start = *low;
  const float per_class = static_cast<float>(kClasses - 1) / std::max(*high - start, 1e-30f);
  const auto class_of = [&](float v) { return static_cast<std::size_t>((v - start) * per_class); };
  std::vector<std::size_t> counts(kClasses + 1);
  for (const float value : values) {
    ++counts[class_of(value)];
  }
  const double wanted = std::ceil(share * static_cast<double>(values.size()));
  std::size_t rank = static_cast<std::size_t>(std::max(wanted, 1.0)) - 1;
  std::size_t chosen = 0;
  while (rank >= counts[chosen]) {
    rank -= counts[chosen];
    ++chosen;
  }
  std::vector<float> candidates;
  std::copy_if(values.begin(), values.end(), std::back_inserter(candidates), [&](float value) {
    return class_of(value) == chosen;
  });
  const auto nth = candidates.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(candidates.begin(), nth, candidates.end());
  return static_cast<double>(*nth);
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
  const auto above = std::count_if(values.begin(), values.end(), [&](float value) {
    return static_cast<double>(value) > threshold;
  });
  return static_cast<double>(above) / static_cast<double>(values.size());
}

struct Deviations {
  double mean = 0.0;
  double rms = 0.0;
  double absolute = 0.0;
};

Deviations deviations_of(const std::vector<float>& values) {
  const auto count = static_cast<double>(values.size());
  Deviations result;
  for (const float value : values) {
    result.mean += static_cast<double>(value);
  }
  result.mean /= count;
  for (const float value : values) {
    const double deviation = static_cast<double>(value) - result.mean;
    result.rms += deviation * deviation;
    result.absolute += std::abs(deviation);
  }
  result.rms = std::sqrt(result.rms / count);
  result.absolute /= count;
  return result;
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
  const double p5 = percentile(values, 0.05);
  const double p95 = percentile(values, 0.95);
  result.robust = p95 > 0.0 ? 1.0 - (p95 - p5) / (p95 + p5) : 0.0;
  return result;
}

double always_clipped_share(const Image<std::uint16_t>& clipped_frames,
                            int frames,
                            const Mask& region) {
  GLINT_CHECK(clipped_frames.size() == region.size(), "counts and region differ in size");
  std::size_t inside = 0;
  std::size_t blind = 0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region.values()[i] != 0) {
      ++inside;
      blind += static_cast<int>(clipped_frames.values()[i]) >= frames ? 1U : 0U;
    }
  }
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

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Homogeneity as it is expected when each pixel scatters normally around its computed value. The
// variance adds to h_rms; to h_abs each pixel adds the expected size of a normal number about its
// mean (folded normal distribution), with erfc by Abramowitz and Stegun, 7.1.26, and beyond five
// deviations nothing. docs/theory/clipped_mean.md, "Noise and few frames". Cost: some thirty
// operations per pixel of the region; no memory.
#include "metrics/aspect_image/noise_variance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/image/spans.h"
#include "core/simd.h"

namespace glint {
namespace {

/// e^-x for x in [0, 80], to 3e-7 of it.
GLINT_INLINE float exp_minus(float x) {
  const float turns = x * 1.44269504F;
  const float whole = std::floor(turns + 0.5F);
  const float f = (whole - turns) * 0.69314718F;
  const float series =
      1.0F + f * (1.0F + f * (0.5F + f * (0.16666667F + f * (0.041666667F + f * 0.0083333333F))));
  return series * std::bit_cast<float>((127 - static_cast<std::int32_t>(whole)) << 23);
}

/// Mean of |x| for a normal number of deviation 1 and mean z in [0, kFar], less z: sqrt(2 / pi)
/// e^(-z^2 / 2) - z erfc(z / sqrt 2), to 1e-6. Source of erfc: Abramowitz and Stegun, 7.1.26.
GLINT_INLINE float excess_at(float z) {
  const float t = 1.0F / (1.0F + 0.3275911F * 0.70710678F * z);
  const float erfc_part =
      t * (0.254829592F +
           t * (-0.284496736F + t * (1.421413741F + t * (-1.453152027F + t * 1.061405429F))));
  return exp_minus(0.5F * z * z) * (0.79788456F - z * erfc_part);
}

/// Beyond so many deviations the mean of |x| is |mean|.
constexpr float kFar = 5.0F;

struct NoiseSums {
  double variance = 0.0;
  double absolute = 0.0;
};

/// Pixels that are worked on together.
constexpr int kBlock = 256;

/// Of numbers >= 0, which are ordered as their bits are.
GLINT_WIDE float largest_of(const float* __restrict values, int count) {
  std::int32_t largest = 0;
  for (int i = 0; i < count; ++i) {
    const auto bits = std::bit_cast<std::int32_t>(values[i]);
    largest = bits > largest ? bits : largest;
  }
  return std::bit_cast<float>(largest);
}

/// For each pixel what scatter adds to the mean size of its deviation from the mean.
GLINT_WIDE void excesses_of(const float* __restrict aspect,
                            const float* __restrict deviation,
                            int count,
                            float mean,
                            float* __restrict excess) {
  for (int i = 0; i < count; ++i) {
    const float sigma = deviation[i];
    const float rest = aspect[i] - mean;
    const float size = rest < 0.0F ? -rest : rest;
    const float far = kFar * sigma;
    const float z = (size < far ? size : far) / (sigma > 1e-20F ? sigma : 1e-20F);
    const float more = sigma * excess_at(z);
    excess[i] = size < far ? more : 0.0F;
  }
}

/// Adds the squares of the deviations and the excesses, eight lanes as independent additions.
GLINT_WIDE NoiseSums sum_of(const float* __restrict deviation,
                            const float* __restrict excess,
                            int count) {
  constexpr int kLanes = 8;
  double variance[kLanes] = {};
  double absolute[kLanes] = {};
  const int whole = count - count % kLanes;
  for (int i = 0; i < whole; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto sigma = static_cast<double>(deviation[i + lane]);
      variance[lane] += sigma * sigma;
      absolute[lane] += static_cast<double>(excess[i + lane]);
    }
  }
  NoiseSums sum;
  for (int i = whole; i < count; ++i) {
    const auto sigma = static_cast<double>(deviation[i]);
    sum.variance += sigma * sigma;
    sum.absolute += static_cast<double>(excess[i]);
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    sum.variance += variance[lane];
    sum.absolute += absolute[lane];
  }
  return sum;
}

NoiseSums noise_sums_of(const float* aspect, const float* deviation, int count, double mean) {
  std::array<float, kBlock> excess = {};
  if (largest_of(deviation, count) == 0.0F) {
    return {};
  }
  excesses_of(aspect, deviation, count, static_cast<float>(mean), excess.data());
  return sum_of(deviation, excess.data(), count);
}

}  // namespace

namespace {

struct RegionNoise : NoiseSums {
  double count = 0.0;  ///< pixels
};

RegionNoise noise_over(const Mask& region,
                       const ImageF& aspect,
                       const ImageF& deviation,
                       double mean) {
  RegionNoise noise;
  for (const RowSpan& span : spans_of(region)) {
    for (int begin = span.begin; begin < span.end; begin += kBlock) {
      const int size = std::min(kBlock, span.end - begin);
      const NoiseSums part =
          noise_sums_of(aspect.row(span.y) + begin, deviation.row(span.y) + begin, size, mean);
      noise.variance += part.variance;
      noise.absolute += part.absolute;
    }
    noise.count += static_cast<double>(span.size());
  }
  return noise;
}

}  // namespace

Homogeneity with_noise_variance(const Homogeneity& homogeneity,
                                const ImageF& aspect,
                                const ImageF& deviation,
                                const Mask& region) {
  if (homogeneity.mean <= 0.0) {
    return homogeneity;
  }
  const RegionNoise noise = noise_over(region, aspect, deviation, homogeneity.mean);
  const double count = noise.count;
  Homogeneity result = homogeneity;
  if (count > 0.0) {
    const double sigma = (1.0 - homogeneity.h_rms) * homogeneity.mean;
    result.h_rms = 1.0 - std::sqrt(sigma * sigma + noise.variance / count) / homogeneity.mean;
    result.h_abs -= noise.absolute / count / homogeneity.mean;
  }
  return result;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sensor's inner loops over one row, compiled for three instruction sets and chosen when the
// program starts. No operation is reordered or contracted, so all three give the same bits.
#pragma once

#include <array>
#include <cstdint>

namespace glint::sensor_kernels {

/// One side of a symmetric filter: rows at distance k below and above the centre.
struct TapRows {
  const float* centre = nullptr;
  const float* const* low = nullptr;   ///< `radius` rows, nearest first
  const float* const* high = nullptr;  ///< `radius` rows, nearest first
  const float* weights = nullptr;      ///< `radius` + 1, centre first
  int radius = 0;
};

/// out = w0 centre + sum_k wk (low_k + high_k), summed from the centre outwards.
void weigh_rows(const TapRows& taps, int width, float* out);

/// values = max(values, 0)
void cut_off_negative(int width, float* values);

/// grey = min(max(scale x values, 0), 1), rounded to multiples of 1 / levels; 0 levels: not
/// rounded.
void to_grey(const float* values, float scale, int levels, int width, float* grey);

/// sum += values; clipped += 1 where a value is 1 or more.
void accumulate(const float* values, int width, double* sum, std::uint16_t* clipped);

/// values = factor x values + offset
void scale_and_shift(float factor, float offset, int width, float* values);

/// Philox words of `blocks` successive counters {first_block + b, stream, frame, 0}: words
/// 4 first_block ... of Rng(seed, stream, frame).
struct NoiseAddress {
  std::array<std::uint32_t, 2> key = {};
  std::uint32_t stream = 0;
  std::uint32_t frame = 0;
};

void philox_words(const NoiseAddress& address,
                  std::uint32_t first_block,
                  int blocks,
                  std::uint32_t* words);

/// Standard normal quantiles of (word + 1/2) / 2^32, to 1e-6 absolute; one word, one number.
/// Source: M. J. Wichura, "Algorithm AS 241: the percentage points of the normal distribution",
/// Applied Statistics 37, 1988 (PPND7).
void normal_quantiles(const std::uint32_t* words, int count, float* normals);

/// electrons += sqrt(electrons) x normals: the Gaussian limit of the Poisson distribution.
void add_shot_noise(const float* normals, int width, float* electrons);

/// electrons += sigma x normals
void add_scaled(float sigma, const float* normals, int width, float* electrons);

}  // namespace glint::sensor_kernels

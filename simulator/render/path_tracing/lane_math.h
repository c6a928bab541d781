// SPDX-License-Identifier: GPL-3.0-or-later
//
// Functions of one float without branches on data, so that a loop over the lanes of a packet
// becomes vector code. Errors are a few 1e-7 of the result unless said otherwise.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/simd.h"

/// A function in versions for narrow and wide instruction sets; the machine's is taken.

namespace glint {

struct SineCosine {
  float sine;
  float cosine;
};

inline constexpr float kPiF = 3.14159265358979F;

/// For angles in [-pi / 4, pi / 4]. Source of the polynomials here: S. Moshier, Cephes library.
GLINT_INLINE SineCosine small_sine_cosine(float angle_rad) {
  const float z = angle_rad * angle_rad;
  const float sine =
      ((-1.9515295891e-4F * z + 8.3321608736e-3F) * z - 1.6666654611e-1F) * z * angle_rad +
      angle_rad;
  const float cosine =
      ((2.443315711809948e-5F * z - 1.388731625493765e-3F) * z + 4.166664568298827e-2F) * z * z -
      0.5F * z + 1.0F;
  return {sine, cosine};
}

/// Of 2 pi turns, turns in [0, 4].
GLINT_INLINE SineCosine sine_cosine_of_turns(float turns) {
  const float quarters = 4.0F * turns;
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): quarters are >= 0, and lround is no lane's
  const auto quadrant = static_cast<std::int32_t>(quarters + 0.5F);
  const SineCosine near =
      small_sine_cosine((quarters - static_cast<float>(quadrant)) * (0.5F * kPiF));
  const bool is_odd = (quadrant & 1) != 0;
  const float sine = is_odd ? near.cosine : near.sine;
  const float cosine = is_odd ? near.sine : near.cosine;
  return {(quadrant & 2) != 0 ? -sine : sine, ((quadrant + 1) & 2) != 0 ? -cosine : cosine};
}

/// Natural logarithm of a normal number > 0; the error is 1e-7 of the larger of it and 1.
GLINT_INLINE float log_of(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const auto raw = static_cast<std::int32_t>(bits >> 23U) - 127;
  const float mantissa = std::bit_cast<float>((bits & 0x007fffffU) | 0x3f800000U);
  const bool is_high = mantissa > 1.41421356F;
  const float f = (is_high ? 0.5F * mantissa : mantissa) - 1.0F;
  const auto e = static_cast<float>(is_high ? raw + 1 : raw);
  const float z = f * f;
  float y = 7.0376836292e-2F * f - 1.1514610310e-1F;
  y = y * f + 1.1676998740e-1F;
  y = y * f - 1.2420140846e-1F;
  y = y * f + 1.4249322787e-1F;
  y = y * f - 1.6668057665e-1F;
  y = y * f + 2.0000714765e-1F;
  y = y * f - 2.4999993993e-1F;
  y = y * f + 3.3333331174e-1F;
  y = y * f * z - 2.12194440e-4F * e - 0.5F * z;
  return f + y + 0.693359375F * e;
}

/// The exponential of x clamped to [-87, 87].
GLINT_INLINE float exp_of(float x) {
  const float low = x > -87.0F ? x : -87.0F;
  const float in = low < 87.0F ? low : 87.0F;
  const auto k = static_cast<std::int32_t>(in * 1.44269504F + (in < 0.0F ? -0.5F : 0.5F));
  const auto kf = static_cast<float>(k);
  const float r = in - kf * 0.693359375F + kf * 2.12194440e-4F;
  float y = 1.9875691500e-4F * r + 1.3981999507e-3F;
  y = y * r + 8.3334519073e-3F;
  y = y * r + 4.1665795894e-2F;
  y = y * r + 1.6666665459e-1F;
  y = y * r + 5.0000001201e-1F;
  y = y * r * r + r + 1.0F;
  return y * std::bit_cast<float>(static_cast<std::uint32_t>(k + 127) << 23U);
}

/// exp(x) - 1 for x >= 0, exact in small results.
GLINT_INLINE float exp_minus_one(float x) {
  const float t = x < 0.5F ? x : 0.5F;
  float y = 1.0F + t * (1.0F / 8.0F);
  y = 1.0F + t * (1.0F / 7.0F) * y;
  y = 1.0F + t * (1.0F / 6.0F) * y;
  y = 1.0F + t * (1.0F / 5.0F) * y;
  y = 1.0F + t * (1.0F / 4.0F) * y;
  y = 1.0F + t * (1.0F / 3.0F) * y;
  y = 1.0F + t * (1.0F / 2.0F) * y;
  return x < 0.5F ? t * y : exp_of(x) - 1.0F;
}

GLINT_INLINE float minimum(float a, float b) {
  return a < b ? a : b;
}

GLINT_INLINE float maximum(float a, float b) {
  return a > b ? a : b;
}

// Instead of && and ||, whose branches keep loops from becoming vector code.
GLINT_INLINE bool both(bool a, bool b) {
  return (static_cast<int>(a) & static_cast<int>(b)) != 0;
}

GLINT_INLINE bool either(bool a, bool b) {
  return (static_cast<int>(a) | static_cast<int>(b)) != 0;
}

/// The power heuristic: the share of the strategy with density a. Source: E. Veach, L. Guibas,
/// "Optimally combining sampling techniques for Monte Carlo rendering", SIGGRAPH 1995.
GLINT_INLINE float power_share(float a, float b) {
  const float ratio = b / a;
  const float share = 1.0F / (1.0F + ratio * ratio);
  return b > 0.0F ? share : 1.0F;
}

}  // namespace glint

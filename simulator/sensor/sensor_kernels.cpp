// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of the sensor over one row: separable blur four taps at a time, grey values, sums,
// Philox random words, normal quantiles by algorithm AS 241 (M. Wichura, Applied Statistics 37,
// 1988) with a logarithm of our own. No operation is reordered or contracted, so every instruction
// set gives the same bits (docs/decisions/0002-bit-identical-results.md). docs/theory/sensor.md. No
// branches, no memory.
#include "simulator/sensor/sensor_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/simd.h"

namespace glint::sensor_kernels {
namespace {

constexpr int kTapsPerPass = 4;

/// Adds kTaps pairs of rows, starting at tap `first`; the first pass also sets the centre.
template <int kTaps, bool kFirst>
GLINT_INLINE void weigh_pass(const TapRows& taps, int first, int width, float* __restrict out) {
  const float* low[kTapsPerPass] = {};
  const float* high[kTapsPerPass] = {};
  float weights[kTapsPerPass] = {};
  for (int k = 0; k < kTaps; ++k) {
    low[k] = taps.low[first + k];
    high[k] = taps.high[first + k];
    weights[k] = taps.weights[first + k + 1];
  }
  const float* centre = taps.centre;
  const float centre_weight = taps.weights[0];
  for (int x = 0; x < width; ++x) {
    float sum = kFirst ? centre_weight * centre[x] : out[x];
    for (int k = 0; k < kTaps; ++k) {
      sum += weights[k] * (low[k][x] + high[k][x]);
    }
    out[x] = sum;
  }
}

template <bool kFirst>
GLINT_INLINE void weigh_some(const TapRows& taps, int first, int width, float* __restrict out) {
  switch (std::min(taps.radius - first, kTapsPerPass)) {
    case 0:
      return weigh_pass<0, kFirst>(taps, first, width, out);
    case 1:
      return weigh_pass<1, kFirst>(taps, first, width, out);
    case 2:
      return weigh_pass<2, kFirst>(taps, first, width, out);
    case 3:
      return weigh_pass<3, kFirst>(taps, first, width, out);
    default:
      return weigh_pass<kTapsPerPass, kFirst>(taps, first, width, out);
  }
}

GLINT_INLINE float clipped_grey(float value) {
  const float positive = value > 0.0f ? value : 0.0f;
  return positive < 1.0f ? positive : 1.0f;
}

/// ln x of a positive normal number, to 1e-7 relative: x = 2^e m, m in [sqrt(1/2), sqrt(2)), and
/// ln m = 2 artanh((m - 1) / (m + 1)) by its series.
GLINT_INLINE float natural_log(float x) {
  constexpr std::uint32_t kSqrtHalf = 0x3F3504F3;
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x) - kSqrtHalf;
  const auto exponent = static_cast<float>(static_cast<std::int32_t>(bits) >> 23);
  const float mantissa = std::bit_cast<float>((bits & 0x007FFFFF) + kSqrtHalf);
  const float s = (mantissa - 1.0f) / (mantissa + 1.0f);
  const float s2 = s * s;
  const float series = 1.0f + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 / 9)));
  return exponent * 0.693147181f + 2.0f * s * series;
}

/// AS 241, centre: the quantile at probability 1/2 + q, |q| <= 0.425.
GLINT_INLINE float central_quantile(float q) {
  const float r = 0.180625f - q * q;
  const float over =
      ((5.9109374720e+01f * r + 1.5929113202e+02f) * r + 5.0434271938e+01f) * r + 3.3871327179e+00f;
  const float under =
      ((6.7187563600e+01f * r + 7.8757757664e+01f) * r + 1.7895169469e+01f) * r + 1.0f;
  return q * over / under;
}

/// AS 241, tail: the magnitude of the quantile at probability tail in [exp(-25), 0.075].
GLINT_INLINE float tail_quantile(float tail) {
  const float r = std::sqrt(-natural_log(tail)) - 1.6f;
  const float over =
      ((1.7023821103e-01f * r + 1.3067284816e+00f) * r + 2.7568153900e+00f) * r + 1.4234372777e+00f;
  const float under = (1.2021132975e-01f * r + 7.3700164250e-01f) * r + 1.0f;
  return over / under;
}

}  // namespace

GLINT_WIDE void weigh_rows(const TapRows& taps, int width, float* __restrict out) {
  weigh_some<true>(taps, 0, width, out);
  for (int first = kTapsPerPass; first < taps.radius; first += kTapsPerPass) {
    weigh_some<false>(taps, first, width, out);
  }
}

GLINT_WIDE void cut_off_negative(int width, float* __restrict values) {
  for (int x = 0; x < width; ++x) {
    values[x] = values[x] > 0.0f ? values[x] : 0.0f;
  }
}

GLINT_WIDE void to_grey(
    const float* __restrict values, float scale, int levels, int width, float* __restrict grey) {
  if (levels == 0) {
    for (int x = 0; x < width; ++x) {
      grey[x] = clipped_grey(scale * values[x]);
    }
    return;
  }
  const auto up = static_cast<float>(levels);
  const float down = 1.0f / up;
  for (int x = 0; x < width; ++x) {
    const float level = clipped_grey(scale * values[x]) * up;
    // NOLINTNEXTLINE(bugprone-incorrect-roundings): values lie in [0, 1], and lround is no loop's
    // friend
    grey[x] = static_cast<float>(static_cast<std::int32_t>(level + 0.5f)) * down;
  }
}

GLINT_WIDE void accumulate(const float* __restrict values,
                           int width,
                           double* __restrict sum,
                           std::uint16_t* __restrict clipped) {
  for (int x = 0; x < width; ++x) {
    sum[x] += static_cast<double>(values[x]);
  }
  for (int x = 0; x < width; ++x) {
    const std::uint16_t full = values[x] >= 1.0f ? 1 : 0;
    clipped[x] = static_cast<std::uint16_t>(clipped[x] + full);
  }
}

GLINT_WIDE void scale_and_shift(float factor, float offset, int width, float* __restrict values) {
  for (int x = 0; x < width; ++x) {
    values[x] = factor * values[x] + offset;
  }
}

GLINT_WIDE void philox_words(const NoiseAddress& address,
                             std::uint32_t first_block,
                             int blocks,
                             std::uint32_t* __restrict words) {
  const NoiseAddress own = address;
  for (int b = 0; b < blocks; ++b) {
    std::uint32_t c0 = first_block + static_cast<std::uint32_t>(b);
    std::uint32_t c1 = own.stream;
    std::uint32_t c2 = own.frame;
    std::uint32_t c3 = 0;
    std::uint32_t key0 = own.key[0];
    std::uint32_t key1 = own.key[1];
#pragma GCC unroll 10
    for (int round = 0; round < 10; ++round) {
      const std::uint64_t product0 = std::uint64_t{0xD2511F53} * c0;
      const std::uint64_t product1 = std::uint64_t{0xCD9E8D57} * c2;
      c0 = static_cast<std::uint32_t>(product1 >> 32) ^ c1 ^ key0;
      c2 = static_cast<std::uint32_t>(product0 >> 32) ^ c3 ^ key1;
      c1 = static_cast<std::uint32_t>(product1);
      c3 = static_cast<std::uint32_t>(product0);
      key0 += 0x9E3779B9;
      key1 += 0xBB67AE85;
    }
    words[4 * b] = c0;
    words[4 * b + 1] = c1;
    words[4 * b + 2] = c2;
    words[4 * b + 3] = c3;
  }
}

GLINT_WIDE void normal_quantiles(const std::uint32_t* __restrict words,
                                 int count,
                                 float* __restrict normals) {
  for (int i = 0; i < count; ++i) {
    // The smaller tail keeps its precision: 1 - u would round to 0 far out.
    const auto above = static_cast<std::int32_t>(words[i] ^ 0x80000000U);
    const std::int32_t magnitude = above < 0 ? ~above : above;
    const float q = (static_cast<float>(magnitude) + 0.5f) * 0x1p-32f;
    const float tail = (static_cast<float>(0x7FFFFFFF - magnitude) + 0.5f) * 0x1p-32f;
    const float far = tail_quantile(tail);
    const float near = central_quantile(q);
    const float normal = q <= 0.425f ? near : far;
    normals[i] = above < 0 ? -normal : normal;
  }
}

GLINT_WIDE void add_shot_noise(const float* __restrict normals,
                               int width,
                               float* __restrict electrons) {
  for (int x = 0; x < width; ++x) {
    electrons[x] += std::sqrt(electrons[x]) * normals[x];
  }
}

GLINT_WIDE void add_scaled(float sigma,
                           const float* __restrict normals,
                           int width,
                           float* __restrict electrons) {
  for (int x = 0; x < width; ++x) {
    electrons[x] += sigma * normals[x];
  }
}

}  // namespace glint::sensor_kernels

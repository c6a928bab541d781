// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of the inspector over rows of pixels: sums of frames, convolution with symmetric
// kernels, masks, counts beside a bracket. 8-bit frames are summed as 16-bit words of two pixels,
// 257 frames at most before they could overflow. Each loop does the same operations in the same
// order for every pixel, so all instruction sets give the same bits. docs/theory/inspection.md.
// Cost: one load per pixel and operand; no memory.
#include "metrics/inspection/filter_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/simd.h"

namespace glint::inspection_kernels {
namespace {

/// So many 8-bit codes always fit into 16 bits: 257 * 255 = 65,535.
constexpr int kFramesOf16Bits = 257;

/// Pixels that are added at a time, as 16-bit words of two.
constexpr int kSumBlock = 64;
using Words = std::uint16_t __attribute__((vector_size(kSumBlock)));

/// sum = that of all frames at kSumBlock pixels from column `begin` on.
GLINT_INLINE void sum_block(const std::uint8_t* const* rows,
                            int frames,
                            int begin,
                            std::uint32_t* __restrict sum) {
  std::fill_n(sum, kSumBlock, 0U);
  for (int first = 0; first < frames; first += kFramesOf16Bits) {
    const int last = std::min(frames, first + kFramesOf16Bits);
    Words even = {};
    Words odd = {};
    for (int j = first; j < last; ++j) {
      Words pairs;
      std::memcpy(&pairs, rows[j] + begin, sizeof(pairs));
      even += pairs & 0xFF;  // little endian: the first pixel is the low byte
      odd += pairs >> 8;
    }
    std::uint16_t evens[kSumBlock / 2];
    std::uint16_t odds[kSumBlock / 2];
    std::memcpy(evens, &even, sizeof(evens));
    std::memcpy(odds, &odd, sizeof(odds));
    for (int i = 0; i < kSumBlock / 2; ++i) {
      sum[2 * i] += evens[i];
      sum[2 * i + 1] += odds[i];
    }
  }
}

/// out += taps[k] (rows[-k] + rows[k]) for k to k + 3.
GLINT_INLINE void add_four_pairs(
    const float* const* rows, const float* taps, int k, int count, float* __restrict out) {
  const float* a = rows[-k];
  const float* b = rows[k];
  const float* c = rows[-k - 1];
  const float* d = rows[k + 1];
  const float* e = rows[-k - 2];
  const float* f = rows[k + 2];
  const float* g = rows[-k - 3];
  const float* h = rows[k + 3];
  const float t0 = taps[k];
  const float t1 = taps[k + 1];
  const float t2 = taps[k + 2];
  const float t3 = taps[k + 3];
  for (int x = 0; x < count; ++x) {
    const float near = t0 * (a[x] + b[x]) + t1 * (c[x] + d[x]);
    const float far = t2 * (e[x] + f[x]) + t3 * (g[x] + h[x]);
    out[x] += near + far;
  }
}

}  // namespace

GLINT_WIDE void sum_rows(const std::uint8_t* const* rows,
                         int frames,
                         int count,
                         std::uint32_t* __restrict sum) {
  if (count < kSumBlock) {
    std::fill_n(sum, count, 0U);
    for (int j = 0; j < frames; ++j) {
      for (int x = 0; x < count; ++x) {
        sum[x] += rows[j][x];
      }
    }
    return;
  }
  for (int begin = 0; begin < count; begin += kSumBlock) {
    // The last block overlaps the one before it rather than being short.
    const int start = std::min(begin, count - kSumBlock);
    sum_block(rows, frames, start, sum + start);
  }
}

GLINT_WIDE void sum_rows(const std::uint16_t* const* rows,
                         int frames,
                         int count,
                         std::uint32_t* __restrict sum) {
  std::fill_n(sum, count, 0U);
  for (int j = 0; j < frames; ++j) {
    const std::uint16_t* row = rows[j];
    for (int x = 0; x < count; ++x) {
      sum[x] += row[x];
    }
  }
}

GLINT_WIDE void sum_rows(const float* const* rows, int frames, int count, double* __restrict sum) {
  std::fill_n(sum, count, 0.0);
  for (int j = 0; j < frames; ++j) {
    const float* row = rows[j];
    for (int x = 0; x < count; ++x) {
      sum[x] += static_cast<double>(row[x]);
    }
  }
}

GLINT_WIDE void divide_small(const std::uint32_t* __restrict sum,
                             int count,
                             float divisor,
                             float* __restrict mean) {
  for (int x = 0; x < count; ++x) {
    mean[x] = static_cast<float>(static_cast<std::int32_t>(sum[x])) / divisor;
  }
}

GLINT_WIDE void divide(const std::uint32_t* __restrict sum,
                       int count,
                       double divisor,
                       float* __restrict mean) {
  for (int x = 0; x < count; ++x) {
    mean[x] = static_cast<float>(static_cast<double>(sum[x]) / divisor);
  }
}

GLINT_WIDE void divide(const double* __restrict sum,
                       int count,
                       double divisor,
                       float* __restrict mean) {
  for (int x = 0; x < count; ++x) {
    mean[x] = static_cast<float>(sum[x] / divisor);
  }
}

GLINT_WIDE bool keep_inside(
    const float* values, const unsigned char* mask, int count, float largest, float* kept) {
  int bad = 0;
  for (int x = 0; x < count; ++x) {
    const float value = values[x];
    bad |= std::abs(value) <= largest ? 0 : 1;
    kept[x] = mask[x] != 0 ? value : 0.0F;
  }
  return bad == 0;
}

GLINT_WIDE void fold(
    const float* const* rows, const float* taps, int radius, int count, float* __restrict out) {
  const float* middle = rows[radius];
  for (int x = 0; x < count; ++x) {
    out[x] = taps[0] * middle[x];
  }
  int k = 1;
  for (; k + 4 <= radius + 1; k += 4) {
    add_four_pairs(rows + radius, taps, k, count, out);
  }
  for (; k <= radius; ++k) {
    const float* before = rows[radius - k];
    const float* after = rows[radius + k];
    for (int x = 0; x < count; ++x) {
      out[x] += taps[k] * (before[x] + after[x]);
    }
  }
}

GLINT_WIDE void add_weighted(const float* __restrict weights,
                             const float* __restrict values,
                             int count,
                             float* __restrict out) {
  for (int x = 0; x < count; ++x) {
    out[x] += weights[x] * values[x];
  }
}

GLINT_WIDE void keep_larger(const float* __restrict values, int count, float* __restrict out) {
  for (int x = 0; x < count; ++x) {
    out[x] = std::abs(values[x]) > std::abs(out[x]) ? values[x] : out[x];
  }
}

GLINT_WIDE void scale_inside(float factor,
                             const float* __restrict values,
                             const unsigned char* __restrict mask,
                             int count,
                             float* __restrict out) {
  for (int x = 0; x < count; ++x) {
    out[x] = mask[x] != 0 ? factor * values[x] : 0.0F;
  }
}

GLINT_WIDE Counts split_readings(const float* __restrict values,
                                 int count,
                                 Reading reading,
                                 float low,
                                 float high,
                                 float* __restrict kept) {
  constexpr int kBlock = 256;
  const std::uint32_t bits = reading.is_distance ? 0x7FFFFFFFU : 0xFFFFFFFFU;
  Counts counts;
  for (int begin = 0; begin < count; begin += kBlock) {
    const int size = std::min(kBlock, count - begin);
    float readings[kBlock];
    int below = 0;
    for (int i = 0; i < size; ++i) {
      const float difference = values[begin + i] - reading.middle;
      readings[i] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(difference) & bits);
      below += readings[i] < low ? 1 : 0;
    }
    for (int i = 0; i < size; ++i) {
      // Always stored, counted only when wanted: cheaper than a branch that cannot be foreseen.
      kept[counts.within] = readings[i];
      const bool is_within = (readings[i] >= low) & (readings[i] <= high);
      counts.within += is_within ? 1 : 0;
    }
    counts.below += below;
  }
  return counts;
}

GLINT_WIDE int find_beyond(const float* row, int x, int count, float low, float high) {
  constexpr int kBlock = 64;
  for (; x + kBlock <= count; x += kBlock) {
    int beyond = 0;
    for (int i = 0; i < kBlock; ++i) {
      beyond |= static_cast<int>(row[x + i] >= high) | static_cast<int>(row[x + i] <= low);
    }
    if (beyond != 0) {
      break;
    }
  }
  while (x < count && !(row[x] >= high || row[x] <= low)) {
    ++x;
  }
  return x;
}

}  // namespace glint::inspection_kernels

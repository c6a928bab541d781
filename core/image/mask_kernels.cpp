// SPDX-License-Identifier: GPL-3.0-or-later
//
// Masks hold a byte a pixel. A square grows in two steps: the union of the rows that it covers,
// then of each pixel and its neighbours along the row, whose number doubles with each pass over the
// row (the union of n pixels and the same n further on is one of 2 n): log2 of the width passes in
// place of the width. All loops are free of branches, sixteen pixels and more an instruction.
// Cost of grow_row() per pixel: an OR for each row, two for each of the ceil(log2(2 radius + 1))
// passes, and a copy. All others read their arrays once, with at most some five operations a pixel.
// docs/theory/inspection_masks.md.
#include "core/image/mask_kernels.h"

#include <bit>
#include <cstdint>

#include "core/simd.h"

namespace glint::mask_kernels {
namespace {

/// to = a | b | c, and what it was if `is_more`
template <bool is_more>
GLINT_INLINE void join_three(const unsigned char* __restrict a,
                             const unsigned char* __restrict b,
                             const unsigned char* __restrict c,
                             int count,
                             unsigned char* __restrict to) {
  for (int i = 0; i < count; ++i) {
    const int before = is_more ? to[i] : 0;
    to[i] = static_cast<unsigned char>(before | a[i] | b[i] | c[i]);
  }
}

}  // namespace

GLINT_WIDE void grow_row(const unsigned char* const* rows,
                         int num_rows,
                         int width,
                         int radius,
                         unsigned char* __restrict scratch,
                         unsigned char* __restrict grown) {
  const int wide = width + 2 * radius;
  unsigned char* from = scratch;
  unsigned char* to = scratch + wide;
  for (int i = 0; i < radius; ++i) {
    from[i] = 0;
    from[i + radius + width] = 0;
  }
  // Three rows at once, the last of them again where there are fewer.
  const int last = num_rows - 1;
  for (int k = 0; k < num_rows; k += 3) {
    const unsigned char* b = rows[k < last ? k + 1 : last];
    const unsigned char* c = rows[k + 1 < last ? k + 2 : last];
    if (k == 0) {
      join_three<false>(rows[k], b, c, width, from + radius);
    } else {
      join_three<true>(rows[k], b, c, width, from + radius);
    }
  }
  // The union of n pixels and the same n further on is one of 2 n.
  const int reach = 2 * radius + 1;
  for (int done = 1, step = 1; done < reach; done += step) {
    step = done < reach - done ? done : reach - done;
    const unsigned char* further = from + step;
    join_three<false>(from, further, further, wide - done - step + 1, to);
    unsigned char* const swapped = from;
    from = to;
    to = swapped;
  }
  for (int i = 0; i < width; ++i) {
    grown[i] = from[i];
  }
}

GLINT_WIDE void subtract(const unsigned char* __restrict a,
                         const unsigned char* __restrict b,
                         int count,
                         unsigned char* __restrict rest) {
  for (int i = 0; i < count; ++i) {
    rest[i] = ((a[i] != 0) & (b[i] == 0)) ? 1 : 0;
  }
}

/// Bytes add up to 255 before they are widened.
GLINT_WIDE int count_ones(const unsigned char* __restrict values, int count) {
  constexpr int kLanes = 64;
  constexpr int kRounds = 255;
  int ones = 0;
  int done = 0;
  while (count - done >= kLanes) {
    const int left = (count - done) / kLanes;
    const int rounds = left < kRounds ? left : kRounds;
    unsigned char sums[kLanes] = {};
    for (int round = 0; round < rounds; ++round, done += kLanes) {
      for (int i = 0; i < kLanes; ++i) {
        sums[i] = static_cast<unsigned char>(sums[i] + values[done + i]);
      }
    }
    for (const unsigned char sum : sums) {
      ones += sum;
    }
  }
  for (; done < count; ++done) {
    ones += values[done];
  }
  return ones;
}

GLINT_WIDE void split_states(const unsigned char* __restrict state,
                             int count,
                             unsigned char* __restrict is_other,
                             unsigned char* __restrict is_lit) {
  for (int i = 0; i < count; ++i) {
    is_other[i] = state[i] != 1 ? 1 : 0;
    is_lit[i] = state[i] != 0 ? 1 : 0;
  }
}

GLINT_WIDE void add_bends(const unsigned char* __restrict is_linear,
                          const unsigned char* __restrict is_beside_other,
                          int count,
                          unsigned char* __restrict is_other) {
  for (int i = 0; i < count; ++i) {
    const bool is_bent = (is_linear[i] == 0) & (is_beside_other[i] == 0);
    is_other[i] = ((is_other[i] != 0) | is_bent) ? 1 : 0;
  }
}

GLINT_WIDE void mark_closed(const unsigned char* __restrict region,
                            const unsigned char* __restrict watched,
                            const unsigned char* __restrict is_near_other,
                            int count,
                            unsigned char* __restrict closed) {
  for (int i = 0; i < count; ++i) {
    closed[i] = ((region[i] != 0) & (watched[i] == 0) & (is_near_other[i] == 0)) ? 1 : 0;
  }
}

GLINT_WIDE void mark_frames(const unsigned char* __restrict region,
                            const unsigned char* __restrict closed,
                            const unsigned char* __restrict is_near_light,
                            int count,
                            unsigned char* __restrict frames) {
  for (int i = 0; i < count; ++i) {
    const bool is_frame = (region[i] != 0) & (closed[i] == 0) & (is_near_light[i] != 0);
    frames[i] = ((frames[i] != 0) | is_frame) ? 1 : 0;
  }
}

/// Numbers that are not negative are ordered as their bits are.
GLINT_WIDE float largest_size(const unsigned char* __restrict mask,
                              const float* __restrict values,
                              const float* __restrict margin,
                              int count) {
  std::int32_t found = 0;
  for (int i = 0; i < count; ++i) {
    const float size = values[i] < 0.0F ? -values[i] : values[i];
    const bool is_used = (mask[i] != 0) & (margin[i] >= 0.0F);
    const auto bits = std::bit_cast<std::int32_t>(is_used ? size : 0.0F);
    found = bits > found ? bits : found;
  }
  return std::bit_cast<float>(found);
}

GLINT_WIDE int count_positive(const float* __restrict values, int count) {
  int found = 0;
  for (int i = 0; i < count; ++i) {
    found += values[i] > 0.0F ? 1 : 0;
  }
  return found;
}

GLINT_WIDE bool is_any_positive(const float* __restrict values, int count) {
  int found = 0;
  for (int i = 0; i < count; ++i) {
    found |= values[i] > 0.0F ? 1 : 0;
  }
  return found != 0;
}

GLINT_WIDE void mark_different(const float* __restrict a,
                               const float* __restrict b,
                               int count,
                               unsigned char* __restrict flags) {
  for (int i = 0; i < count; ++i) {
    flags[i] = static_cast<unsigned char>(flags[i] | (a[i] != b[i] ? 1 : 0));
  }
}

}  // namespace glint::mask_kernels

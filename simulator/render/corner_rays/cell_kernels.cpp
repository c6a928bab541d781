// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which cells of a row are certainly smooth, 64 at a time in float: the rule of check_cell() for
// cells whose twelve surrounding rays all took the same path. Interpolating linearly over a cell
// errs by an eighth of the second differences, which are compared as squared lengths, with a margin
// of 1 % and an allowance for rounding; a cell that is not marked here is checked by the exact
// rule. docs/theory/footprints.md, "When four corners are not enough". Cost: one pass over the six
// components of four rows of rays; less than 10 kB on the stack.
#include "simulator/render/corner_rays/cell_kernels.h"

#include <cmath>

#include "core/simd.h"

namespace glint {
namespace {

/// Cells are checked a chunk at a time, so that what is kept of them stays in registers and cache.
constexpr int kChunk = 64;
constexpr float kMargin = 0.99F;
constexpr float kRounding_rad = 1e-6F;
constexpr float kRounding_mm = 1e-4F;

/// Squares of what is compared, summed up over x, y and z.
struct alignas(64) Sums {
  float bend_x[4][kChunk], bend_y[4][kChunk], twist[kChunk];
  float width[2][kChunk], height[2][kChunk];
};

GLINT_INLINE float bend(float a, float b, float c) {
  const float second = (a - b) - (b - c);
  return second * second;
}

GLINT_INLINE float square(float a) {
  return a * a;
}

GLINT_INLINE float larger(float a, float b) {
  return a > b ? a : b;
}

/// Adds one component of four lines, from cell `first` on.
GLINT_INLINE void add_component(const float* const* lines, int first, int count, Sums& s) {
  const float* __restrict a = lines[0] + first;
  const float* __restrict b = lines[1] + first;
  const float* __restrict c = lines[2] + first;
  const float* __restrict d = lines[3] + first;
  for (int i = 0; i < count; ++i) {
    s.bend_x[0][i] += bend(b[i - 1], b[i], b[i + 1]);
    s.bend_x[1][i] += bend(b[i], b[i + 1], b[i + 2]);
    s.bend_x[2][i] += bend(c[i - 1], c[i], c[i + 1]);
    s.bend_x[3][i] += bend(c[i], c[i + 1], c[i + 2]);
    s.bend_y[0][i] += bend(a[i], b[i], c[i]);
    s.bend_y[1][i] += bend(b[i], c[i], d[i]);
    s.bend_y[2][i] += bend(a[i + 1], b[i + 1], c[i + 1]);
    s.bend_y[3][i] += bend(b[i + 1], c[i + 1], d[i + 1]);
    s.twist[i] += square((c[i + 1] - c[i]) - (b[i + 1] - b[i]));
    s.width[0][i] += square(b[i + 1] - b[i]);
    s.width[1][i] += square(c[i + 1] - c[i]);
    s.height[0][i] += square(c[i] - b[i]);
    s.height[1][i] += square(c[i + 1] - b[i + 1]);
  }
}

GLINT_INLINE float largest(const float (*bends)[kChunk], int i) {
  return larger(larger(bends[0][i], bends[1][i]), larger(bends[2][i], bends[3][i]));
}

/// 1 where all twelve rays took the wanted path and no two of them met different patches; free
/// triangles are -1, so that the largest piece is the patch if there is one.
GLINT_INLINE void mark_alike(
    const CornerLine* lines, std::uint8_t wanted, int first, int count, std::int32_t* alike) {
  for (int i = 0; i < count; ++i) {
    const int x = first + i;
    std::int32_t patch = -1;
    std::int32_t differs = 0;
    for (int k = 0; k < 4; ++k) {
      const int from = k == 0 || k == 3 ? 0 : -1;
      const int to = k == 0 || k == 3 ? 1 : 2;
      for (int j = from; j <= to; ++j) {
        const std::int32_t piece = lines[k].piece[x + j];
        patch = piece > patch ? piece : patch;
        differs |= lines[k].path[x + j] ^ wanted;
      }
    }
    for (int k = 0; k < 4; ++k) {
      const int from = k == 0 || k == 3 ? 0 : -1;
      const int to = k == 0 || k == 3 ? 1 : 2;
      for (int j = from; j <= to; ++j) {
        const std::int32_t piece = lines[k].piece[x + j];
        differs |= (piece ^ patch) & ~(piece >> 31);
      }
    }
    alike[i] = differs == 0 ? 1 : 0;
  }
}

}  // namespace

GLINT_WIDE void mark_smooth_cells(const CornerLine* lines,
                                  int num_cells,
                                  const CellLimits& limits,
                                  std::uint8_t* is_smooth) {
  for (int x = 0; x < num_cells; ++x) {
    is_smooth[x] = 0;
  }
  for (int first = 1; first < num_cells - 1; first += kChunk) {
    const int count = num_cells - 1 - first < kChunk ? num_cells - 1 - first : kChunk;
    Sums directions = {};
    Sums origins = {};
    alignas(64) std::int32_t alike[kChunk];
    mark_alike(lines, limits.wanted_path, first, count, alike);
    for (int k = 0; k < 3; ++k) {
      const float* const direction[4] = {lines[0].direction[k],
                                         lines[1].direction[k],
                                         lines[2].direction[k],
                                         lines[3].direction[k]};
      const float* const origin[4] = {
          lines[0].origin[k], lines[1].origin[k], lines[2].origin[k], lines[3].origin[k]};
      add_component(direction, first, count, directions);
      add_component(origin, first, count, origins);
    }
    const std::int32_t* above = lines[1].piece + first;
    const std::int32_t* below = lines[2].piece + first;
    for (int i = 0; i < count; ++i) {
      const std::int32_t is_free = (above[i] | above[i + 1] | below[i] | below[i + 1]) >> 31;
      const float per_bend = is_free != 0 ? limits.error_per_kink : limits.error_per_bend;
      const float error = per_bend * (std::sqrt(largest(directions.bend_x, i)) +
                                      std::sqrt(largest(directions.bend_y, i))) +
                          limits.error_per_bend * std::sqrt(directions.twist[i]);
      const float width =
          origins.width[0][i] < origins.width[1][i] ? origins.width[0][i] : origins.width[1][i];
      const float height =
          origins.height[0][i] < origins.height[1][i] ? origins.height[0][i] : origins.height[1][i];
      const float share = kMargin * limits.max_jump_share;
      const bool is_low = error + kRounding_rad <= kMargin * limits.max_error_rad;
      const float jump_x = std::sqrt(largest(origins.bend_x, i)) + kRounding_mm;
      const float jump_y = std::sqrt(largest(origins.bend_y, i)) + kRounding_mm;
      const bool is_even_x = jump_x <= share * std::sqrt(width);
      const bool is_even_y = jump_y <= share * std::sqrt(height);
      const bool is_alike = alike[i] != 0;
      is_smooth[first + i] = (is_alike & is_low & is_even_x & is_even_y) ? 1 : 0;
    }
  }
}

}  // namespace glint

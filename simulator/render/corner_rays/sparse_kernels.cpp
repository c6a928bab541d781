// SPDX-License-Identifier: GPL-3.0-or-later
//
// Interpolation between every eighth ray: Lagrange's quintic through six nodes, first down the
// columns (blend_rows()), then along the rows (spread()); its error at rays that are known; and
// bounds of it over a tile, from the nodes and their second differences. The weights are
// compile-time constants. docs/theory/footprints.md, "Between every eighth ray". Cost: six
// multiplications per value and direction, without branches; no memory.
#include "simulator/render/corner_rays/sparse_kernels.h"

#include "core/simd.h"

namespace glint::sparse_kernels {
namespace {

constexpr float kInfinity = __builtin_inff();

/// Weights of one node for all places of a stretch.
struct SpreadWeights {
  float of[kNodes][kStep];

  constexpr SpreadWeights() : of{} {
    for (int place = 0; place < kStep; ++place) {
      const NodeWeights weights = kNodeWeights[static_cast<unsigned>(place)];
      for (int node = 0; node < kNodes; ++node) {
        of[node][place] = weights[static_cast<unsigned>(node)];
      }
    }
  }
};

constexpr SpreadWeights kSpread;

GLINT_INLINE float distance(float a, float b) {
  const float difference = a < b ? b - a : a - b;
  return difference <= kInfinity ? difference : kInfinity;  // not a number: infinity
}

}  // namespace

GLINT_WIDE void blend_rows(const NodeRows& rows,
                           const NodeWeights& weights,
                           int count,
                           float* __restrict out) {
  const float* __restrict a = rows[0];
  const float* __restrict b = rows[1];
  const float* __restrict c = rows[2];
  const float* __restrict d = rows[3];
  const float* __restrict e = rows[4];
  const float* __restrict f = rows[5];
  const NodeWeights w = weights;
  for (int i = 0; i < count; ++i) {
    out[i] =
        (w[0] * a[i] + w[1] * b[i]) + (w[2] * c[i] + w[3] * d[i]) + (w[4] * e[i] + w[5] * f[i]);
  }
}

GLINT_WIDE void spread(const float* __restrict nodes, int tiles, float* __restrict out) {
  for (int i = 0; i < tiles; ++i) {
    const float a = nodes[i], b = nodes[i + 1], c = nodes[i + 2];
    const float d = nodes[i + 3], e = nodes[i + 4], f = nodes[i + 5];
    for (int place = 0; place < kStep; ++place) {
      out[i * kStep + place] = (kSpread.of[0][place] * a + kSpread.of[1][place] * b) +
                               (kSpread.of[2][place] * c + kSpread.of[3][place] * d) +
                               (kSpread.of[4][place] * e + kSpread.of[5][place] * f);
    }
  }
}

GLINT_WIDE void find_errors(const float* __restrict nodes,
                            const float* __restrict values,
                            const NodeWeights& weights,
                            int tiles,
                            float* __restrict errors) {
  const NodeWeights w = weights;
  for (int i = 0; i < tiles; ++i) {
    const float quintic = (w[0] * nodes[i] + w[1] * nodes[i + 1]) +
                          (w[2] * nodes[i + 2] + w[3] * nodes[i + 3]) +
                          (w[4] * nodes[i + 4] + w[5] * nodes[i + 5]);
    const float error = distance(values[i], quintic);
    errors[i] = error > errors[i] ? error : errors[i];
  }
}

GLINT_WIDE void find_errors_of_all(const float* __restrict spread_values,
                                   const float* __restrict values,
                                   int tiles,
                                   float* __restrict errors) {
  for (int i = 0; i < tiles; ++i) {
    float largest = errors[i];
    for (int place = 0; place < kStep; ++place) {
      const float error = distance(values[i * kStep + place], spread_values[i * kStep + place]);
      largest = error > largest ? error : largest;
    }
    errors[i] = largest;
  }
}

GLINT_WIDE void allow_errors(const float* __restrict top,
                             const float* __restrict bottom,
                             int tiles,
                             float share,
                             float* __restrict allowed) {
  for (int i = 0; i < tiles; ++i) {
    const float low_top = top[i] < top[i + 1] ? top[i] : top[i + 1];
    const float high_top = top[i] < top[i + 1] ? top[i + 1] : top[i];
    const float low_bottom = bottom[i] < bottom[i + 1] ? bottom[i] : bottom[i + 1];
    const float high_bottom = bottom[i] < bottom[i + 1] ? bottom[i + 1] : bottom[i];
    const float low = low_top < low_bottom ? low_top : low_bottom;
    const float high = high_top < high_bottom ? high_bottom : high_top;
    const float range = share * (high - low);
    allowed[i] = range > allowed[i] ? range : allowed[i];
  }
}

namespace {

GLINT_INLINE float smaller(float a, float b) {
  return a < b ? a : b;
}

GLINT_INLINE float larger(float a, float b) {
  return a < b ? b : a;
}

/// Size of the second difference at the middle one of three nodes.
GLINT_INLINE float bend(float a, float b, float c) {
  const float twice = (a - b) - (b - c);
  return twice < 0.0F ? -twice : twice;
}

}  // namespace

GLINT_WIDE void allow_more(const AcrossLimits& limits,
                           int tiles,
                           float half_slot_mm,
                           float times,
                           float* __restrict allowed) {
  const float* __restrict y_low = limits.y_low;
  const float* __restrict y_high = limits.y_high;
  const float* __restrict margin_low = limits.margin_low;
  const float* __restrict margin_high = limits.margin_high;
  for (int i = 0; i < tiles; ++i) {
    const float more = times * allowed[i];
    const float low = y_low[i] - more;
    const float high = y_high[i] + more;
    const bool is_beside = (low > half_slot_mm) | (high < -half_slot_mm);
    const bool is_in_slot = (low > -half_slot_mm) & (high < half_slot_mm);
    const bool is_off_rim = (margin_low[i] - more > 0.0F) | (margin_high[i] + more < 0.0F);
    allowed[i] = ((is_beside | is_in_slot) & is_off_rim) ? more : allowed[i];
  }
}

GLINT_WIDE void allow_share(const float* __restrict low,
                            const float* __restrict high,
                            int tiles,
                            float share,
                            float* __restrict allowed) {
  for (int i = 0; i < tiles; ++i) {
    const float distance = larger(low[i], -high[i]);
    allowed[i] = larger(allowed[i], share * distance);
  }
}

GLINT_WIDE void keep_allowed(const float* __restrict errors,
                             const float* __restrict allowed,
                             int tiles,
                             unsigned char* __restrict flags) {
  for (int i = 0; i < tiles; ++i) {
    flags[i] = static_cast<unsigned char>(flags[i] & (errors[i] <= allowed[i] ? 1 : 0));
  }
}

/// In the middle between nodes 0 and 1 the quintic is the straight line less 19/256 of the second
/// differences there and plus 3/256 of the next ones: 44/256 of the largest at most. Those down the
/// columns are themselves taken from six nodes, whose weights sum to 356/256 in size.
GLINT_WIDE void find_limits(const NodeRows& rows,
                            int tiles,
                            float* __restrict low,
                            float* __restrict high,
                            float* __restrict scratch) {
  const float* __restrict a = rows[0];
  const float* __restrict b = rows[1];
  const float* __restrict c = rows[2];
  const float* __restrict d = rows[3];
  const float* __restrict e = rows[4];
  const float* __restrict f = rows[5];
  const int nodes = tiles + kNodes - 1;
  for (int k = 0; k < nodes; ++k) {
    const float upper = larger(bend(a[k], b[k], c[k]), bend(b[k], c[k], d[k]));
    const float lower = larger(bend(c[k], d[k], e[k]), bend(d[k], e[k], f[k]));
    scratch[k] = larger(upper, lower);
  }
  for (int i = 0; i < tiles; ++i) {
    const float* down = scratch + i;
    const float max_down = larger(larger(larger(down[0], down[1]), larger(down[2], down[3])),
                                  larger(down[4], down[5]));
    const float upper =
        larger(larger(bend(c[i], c[i + 1], c[i + 2]), bend(c[i + 1], c[i + 2], c[i + 3])),
               larger(bend(c[i + 2], c[i + 3], c[i + 4]), bend(c[i + 3], c[i + 4], c[i + 5])));
    const float lower =
        larger(larger(bend(d[i], d[i + 1], d[i + 2]), bend(d[i + 1], d[i + 2], d[i + 3])),
               larger(bend(d[i + 2], d[i + 3], d[i + 4]), bend(d[i + 3], d[i + 4], d[i + 5])));
    const float bulge = 0.18F * larger(upper, lower) + 0.25F * max_down;
    const float minimum = smaller(smaller(c[i + 2], c[i + 3]), smaller(d[i + 2], d[i + 3]));
    const float maximum = larger(larger(c[i + 2], c[i + 3]), larger(d[i + 2], d[i + 3]));
    low[i] = minimum - bulge;
    high[i] = maximum + bulge;
  }
}

}  // namespace glint::sparse_kernels

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which boundary of the light cuts a pixel: the slot's edges and the rim are linear functions
// through the four corners, and a pixel is simple where one of them alone changes its sign within
// the square and no corner is near the tunnel's ends. Signs are decided with the rounding error
// allowed for, and choices are selections instead of branches. Own derivation:
// docs/theory/footprints.md, "Polygons". Cost: some 100 operations a pixel, linear in pixels;
// memory: a batch of the caller's.
#include "simulator/render/footprint/cut_limits.h"

#include <cstdint>

#include "core/simd.h"
#include "simulator/render/footprint/corner_lane.h"
#include "simulator/render/footprint/footprint_lane.h"

namespace glint::cut_kernels {
namespace {

using corner_lane::larger;
using corner_lane::Linear;
using corner_lane::linear_at;
using corner_lane::smaller;
using footprint_lane::absolute;
using footprint_lane::Range;

GLINT_INLINE Range range_at(const Corners& corners, int i) {
  const float* a = corners.at[0];
  const float* b = corners.at[1];
  const float* c = corners.at[2];
  const float* d = corners.at[3];
  return {smaller(smaller(a[i], b[i]), smaller(c[i], d[i])),
          larger(larger(a[i], b[i]), larger(c[i], d[i]))};
}

/// How far a linear function goes from its middle; rounding errors allowed for.
GLINT_INLINE double reach_of(const Linear& f) {
  constexpr double kRounding = 1e-12;
  const double reach = 0.5 * (absolute(f.dx) + absolute(f.dy));
  return reach + kRounding * (absolute(f.value) + reach);
}

}  // namespace

GLINT_WIDE void find_cuts(const CornerBatch& pixels,
                          const CutLimits& limits,
                          LinearBatch& inside,
                          unsigned char* __restrict is_simple) {
  const CutLimits l = limits;
  const int count = pixels.count;
  double* __restrict value = inside.value;
  double* __restrict dx = inside.dx;
  double* __restrict dy = inside.dy;
  int simple[kBatch];
  for (int i = 0; i < count; ++i) {
    const Linear margin = linear_at(pixels.margin_mm, i);
    const Linear y = linear_at(pixels.y_mm, i);
    const Range y_mm = range_at(pixels.y_mm, i);
    const double margin_reach = reach_of(margin);
    const bool is_at_rim = margin.value - margin_reach < 0.0;
    const bool is_beside = (static_cast<double>(y_mm.low) >= l.half_slot_mm) |
                           (static_cast<double>(y_mm.high) <= -l.half_slot_mm);
    const double to_right = y.value - l.half_slot_mm;
    const double to_left = -l.half_slot_mm - y.value;
    const bool is_right = to_right + reach_of({to_right, y.dx, y.dy}) >= 0.0;
    const bool is_left = to_left + reach_of({to_left, y.dx, y.dy}) >= 0.0;
    const double beside_value = is_at_rim ? margin.value : 1.0;
    const double beside_dx = is_at_rim ? margin.dx : 0.0;
    const double beside_dy = is_at_rim ? margin.dy : 0.0;
    value[i] = is_beside ? beside_value : (is_left ? to_left : to_right);
    dx[i] = is_beside ? beside_dx : (is_left ? -y.dx : y.dx);
    dy[i] = is_beside ? beside_dy : (is_left ? -y.dy : y.dy);
    const bool is_one_line = is_beside | (!is_at_rim & !(is_left & is_right));
    simple[i] = is_one_line ? 1 : 0;
  }
  for (int i = 0; i < count; ++i) {
    const Range x_mm = range_at(pixels.x_mm, i);
    const Range margin_mm = range_at(pixels.margin_mm, i);
    const bool is_on_wall = margin_mm.low >= l.no_hit_below_mm;
    const bool is_inside_ends = (x_mm.low > l.x_low_mm) & (x_mm.high < l.x_high_mm);
    is_simple[i] = ((simple[i] != 0) & is_on_wall & is_inside_ends) ? 1 : 0;
  }
}

GLINT_WIDE void mean_gains(const CornerBatch& __restrict pixels,
                           const CutLimits& limits,
                           float* __restrict gain,
                           unsigned char* __restrict is_clear) {
  constexpr float kFar = 1e30F;
  const auto half_slot_mm = static_cast<float>(limits.half_slot_mm);
  const float x_low_mm = limits.x_low_mm;
  const float x_high_mm = limits.x_high_mm;
  const int count = pixels.count;
  std::int32_t clear[kBatch];
  for (int i = 0; i < count; ++i) {
    float seen = 0.0F;
    float sum = 0.0F;
    Range x = {kFar, -kFar};
    Range y = {kFar, -kFar};
    Range margin = {kFar, -kFar};
    for (int k = 0; k < 4; ++k) {
      const float at = pixels.gain.at[k][i];
      const float at_x = pixels.x_mm.at[k][i];
      const float at_y = pixels.y_mm.at[k][i];
      const float at_margin = pixels.margin_mm.at[k][i];
      const bool is_seen = at > 0.0F;
      seen += is_seen ? 1.0F : 0.0F;
      sum += is_seen ? at : 0.0F;
      x.low = (is_seen & (at_x < x.low)) ? at_x : x.low;
      x.high = (is_seen & (at_x > x.high)) ? at_x : x.high;
      y.low = (is_seen & (at_y < y.low)) ? at_y : y.low;
      y.high = (is_seen & (at_y > y.high)) ? at_y : y.high;
      margin.low = (is_seen & (at_margin < margin.low)) ? at_margin : margin.low;
      margin.high = (is_seen & (at_margin > margin.high)) ? at_margin : margin.high;
    }
    const float x_size = x.high - x.low;
    const float y_size = y.high - y.low;
    const bool is_beside = (y.low - y_size >= half_slot_mm) | (y.high + y_size <= -half_slot_mm);
    const bool is_on_wall = margin.low >= margin.high - margin.low;
    const bool is_inside = (x.low - x_size > x_low_mm) & (x.high + x_size < x_high_mm);
    gain[i] = sum / (seen > 1.0F ? seen : 1.0F);
    clear[i] = ((seen > 1.5F) & is_beside & is_on_wall & is_inside) ? 1 : 0;
  }
  for (int i = 0; i < count; ++i) {
    is_clear[i] = static_cast<unsigned char>(clear[i]);
  }
}

}  // namespace glint::cut_kernels

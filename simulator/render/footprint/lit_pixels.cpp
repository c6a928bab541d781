// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pixels need no look at their corners' hits: each corner gets one bit a condition (on the
// wall, off it, left or right of the slot, in it, inside the ends at all positions of the scan),
// and what holds for a whole pixel is the conjunction of its four bytes, as each condition is a
// half-plane or a strip and a pixel's footprint is taken as the hull of its corners. Tiles are
// decided likewise by the bounds of their hits. Own derivation: docs/theory/footprints.md, "Between
// every eighth ray". Cost: some 20 operations a corner and as many a pixel; memory: a byte each.
#include "simulator/render/footprint/lit_pixels.h"

#include "core/simd.h"
#include "simulator/render/footprint/footprint_lane.h"

namespace glint::footprint_kernels {
namespace {

using footprint_lane::Range;
using footprint_lane::range_of;

/// What corner_codes() says of a corner.
enum CornerCode : unsigned char {
  kOnWall = 1,
  kOffWall = 2,
  kRightOfSlot = 4,
  kLeftOfSlot = 8,
  kInSlot = 16,
  kInsideEnds = 32
};

}  // namespace

GLINT_WIDE void corner_codes(const float* __restrict x_mm,
                             const float* __restrict y_mm,
                             const float* __restrict margin_mm,
                             int count,
                             const LitLimits& limits,
                             unsigned char* __restrict codes) {
  const LitLimits l = limits;
  for (int i = 0; i < count; ++i) {
    const float x = x_mm[i];
    const float y = y_mm[i];
    const float margin = margin_mm[i];
    int code = margin >= 0.0F ? kOnWall : 0;
    code |= margin < 0.0F ? kOffWall : 0;
    code |= y >= l.half_slot_mm ? kRightOfSlot : 0;
    code |= y <= -l.half_slot_mm ? kLeftOfSlot : 0;
    code |= ((y > -l.half_slot_mm) & (y < l.half_slot_mm)) ? kInSlot : 0;
    code |= ((x > l.x_low_mm) & (x < l.x_high_mm)) ? kInsideEnds : 0;
    codes[i] = static_cast<unsigned char>(code);
  }
}

namespace {

/// 1 where the stripes at a pixel's corners differ by no more than `widest`.
GLINT_WIDE void mark_narrow(const float* __restrict top,
                            const float* __restrict bottom,
                            int count,
                            float widest_mm,
                            unsigned char* __restrict is_narrow) {
  for (int i = 0; i < count; ++i) {
    const Range v = range_of(top, bottom, i);
    is_narrow[i] = v.high - v.low <= widest_mm ? 1 : 0;
  }
}

/// @param state  1 for narrow pixels, else 0; the result
GLINT_WIDE void combine_codes(const unsigned char* __restrict top,
                              const unsigned char* __restrict bottom,
                              const unsigned char* __restrict kind,
                              const unsigned char* __restrict occluded,
                              int count,
                              unsigned char* __restrict state) {
  constexpr unsigned char kLit = kOnWall | kInsideEnds;
  for (int i = 0; i < count; ++i) {
    const auto all = static_cast<unsigned char>(top[i] & top[i + 1] & bottom[i] & bottom[i + 1]);
    const bool is_beside_slot = (all & (kRightOfSlot | kLeftOfSlot)) != 0;
    const bool is_never_lit = (all & (kOffWall | kInSlot)) != 0;
    const bool is_plain = ((all & kLit) == kLit) & is_beside_slot & (state[i] != 0);
    const unsigned char other = is_never_lit ? 0 : 2;
    const unsigned char by_light = is_plain ? 1 : other;
    const unsigned char by_kind = kind[i] == 2 ? 2 : by_light;
    const bool is_dark = (kind[i] == 0) | (occluded[i] != 0);
    state[i] = is_dark ? 0 : by_kind;
  }
}

}  // namespace

void classify(const unsigned char* top,
              const unsigned char* bottom,
              const CornerRows& stripes_mm,
              const unsigned char* kind,
              const unsigned char* occluded,
              int count,
              const LitLimits& limits,
              unsigned char* state) {
  mark_narrow(stripes_mm.top, stripes_mm.bottom, count, limits.widest_mm, state);
  combine_codes(top, bottom, kind, occluded, count, state);
}

GLINT_WIDE void even_tiles(const TileRow& tiles,
                           int count,
                           const LitLimits& limits,
                           unsigned char* __restrict is_even) {
  const TileRow t = tiles;
  const LitLimits l = limits;
  for (int i = 0; i < count; ++i) {
    const bool is_beside_slot = (t.y_low[i] >= l.half_slot_mm) | (t.y_high[i] <= -l.half_slot_mm);
    const bool is_inside = (t.x_low[i] > l.x_low_mm) & (t.x_high[i] < l.x_high_mm);
    const bool is_narrow = t.stripes_high[i] - t.stripes_low[i] <= l.widest_mm;
    const bool is_lit = (t.margin_low[i] >= 0.0F) & is_beside_slot & is_inside & is_narrow;
    is_even[i] = ((t.kind[i] == 2) | ((t.kind[i] == 1) & is_lit)) ? 1 : 0;
  }
}

GLINT_WIDE void plain_states(const unsigned char* __restrict kind,
                             const unsigned char* __restrict occluded,
                             int count,
                             unsigned char* __restrict state) {
  for (int i = 0; i < count; ++i) {
    state[i] = occluded[i] != 0 ? 0 : kind[i];
  }
}

}  // namespace glint::footprint_kernels

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pixels the boundaries of the light cut, and where: many at a time, as cut_kernels.h.
#pragma once

#include "simulator/render/footprint/cut_kernels.h"

namespace glint::cut_kernels {

/// Boundaries of the light and where they are looked for.
struct CutLimits {
  double half_slot_mm = 0.0;
  float x_low_mm = 0.0F;  ///< the tunnel's ends never pass what is between these
  float x_high_mm = 0.0F;
  float no_hit_below_mm = 0.0F;  ///< lower margins are no places on the wall
};

/// What of each pixel the slot's edge or the rim leaves: where `inside` is >= 0.
/// @param is_simple  1 for pixels that one line describes, 0 for others: both boundaries, two edges
///                   of the slot, ends, or corners beside the wall
void find_cuts(const CornerBatch& pixels,
               const CutLimits& limits,
               LinearBatch& inside,
               unsigned char* is_simple);

/// The mean of the corners' gain where it is > 0.
/// @param is_clear  1 where at least two corners have gain, and a boundary of the light is further
///                  from them than they are from each other
void mean_gains(const CornerBatch& pixels,
                const CutLimits& limits,
                float* gain,
                unsigned char* is_clear);

}  // namespace glint::cut_kernels

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pixels and tiles are lit at every position of a scan, row by row: kernels as those of
// footprint_kernels.h.
#pragma once

#include "simulator/render/footprint/footprint_kernels.h"

namespace glint::footprint_kernels {

/// Where corners are lit at every position of a scan.
struct LitLimits {
  float half_slot_mm = 0.0F;
  float x_low_mm = 0.0F;
  float x_high_mm = 0.0F;
  float widest_mm = 0.0F;  ///< stripes differ by no more than this between plain corners
};

/// What holds at each corner, one bit a condition: what holds for all corners of a pixel is the
/// conjunction of their four.
void corner_codes(const float* x_mm,
                  const float* y_mm,
                  const float* margin_mm,
                  int count,
                  const LitLimits& limits,
                  unsigned char* codes);

/// For each pixel 0 where no part of it is ever lit, 1 where all of it always is, else 2. Pixels
/// that see no part (kind 0) or that the wall hides are 0, refined ones (kind 2) that are not
/// are 2.
/// @param top, bottom  codes of the corners
void classify(const unsigned char* top,
              const unsigned char* bottom,
              const CornerRows& stripes_mm,
              const unsigned char* kind,
              const unsigned char* occluded,
              int count,
              const LitLimits& limits,
              unsigned char* state);

/// Limits of the hits in tiles, and what is known of them (TileLimits).
struct TileRow {
  const float* x_low = nullptr;
  const float* x_high = nullptr;
  const float* y_low = nullptr;
  const float* y_high = nullptr;
  const float* margin_low = nullptr;
  const float* stripes_low = nullptr;
  const float* stripes_high = nullptr;
  const unsigned char* kind = nullptr;  ///< 0 unknown, 1 known, 2 no rays
};

/// 1 for tiles whose smooth pixels are all plain, or that have none.
void even_tiles(const TileRow& tiles, int count, const LitLimits& limits, unsigned char* is_even);

/// The states of pixels between corners that are lit at every position.
void plain_states(const unsigned char* kind,
                  const unsigned char* occluded,
                  int count,
                  unsigned char* state);

}  // namespace glint::footprint_kernels

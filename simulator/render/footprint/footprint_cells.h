// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels on a boundary of the light, with footprints wider than the stripes, or refined: summed
// from cells (docs/theory/footprints.md).
#pragma once

#include <cstdint>
#include <vector>

#include "core/image/image.h"
#include "core/image/spans.h"

namespace glint {

class Footprints;

/// Radiance of pixels that are summed from cells, at all positions of a scan or their mean.
struct PixelCells {
  std::vector<std::int32_t> pixels;  ///< index y * width + x
  std::vector<float> values;         ///< as many for each pixel
};

/// The pixels of State::kCells among the given ones, at all positions.
PixelCells sum_cells(const Footprints& footprints, const Spans& where);

/// Their mean over a scan of whole periods: one value a pixel.
/// @param near  refined pixels elsewhere may be taken from their four corners and their coverage
PixelCells mean_of_cells(const Footprints& footprints, const Spans& where, const Spans& near);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which tiles of a picture few frames disturb so much that the table T(w) will not do.
// docs/theory/clipped_mean.md, "Few frames".
#pragma once

#include "simulator/render/scan/scan_plan.h"

namespace glint {

/// Fills the plan's ripple and correction. The pixels of tiles that disturb most go from the table
/// to the frames, until what the others may be wrong by moves h by less than 0.05 point; all go
/// when that would be most of them.
/// @param region_pixels  to be scored, those that neither form gives included
/// @param plan           with its table, widths and pixels
void sort_tiles(const Footprints& footprints,
                const Sensor& sensor,
                int region_pixels,
                ScanPlan& plan);

}  // namespace glint

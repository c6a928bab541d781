// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/image/spans.h"
#include "simulator/render/derivative/scan_gradient.h"
#include "simulator/render/footprint/footprint_cells.h"

namespace glint {

/// Adds the derivatives of the pixels whose mean is that of rendered frames: in reverse mode
/// through clipping, blur and footprints, frame by frame.
/// @param wanted  these pixels
/// @param wants   sums that cost extra
/// @param cells   of the frames around them, if known
void add_frame_gradient(const Footprints& footprints,
                        const Sensor& sensor,
                        const Spans& wanted,
                        const ImageF& by_aspect,
                        const WantedDerivatives& wants,
                        std::shared_ptr<const PixelCells> cells,
                        ScanGradient& gradient);

}  // namespace glint

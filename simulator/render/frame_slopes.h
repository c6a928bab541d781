// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/render/scan_slopes.h"

namespace glint {

/// Adds the slopes of the pixels whose mean is that of rendered frames: backwards through clipping,
/// blur and footprints, frame by frame.
/// @param by_frames  these pixels
void add_frame_slopes(const Footprints& footprints,
                      const Sensor& sensor,
                      const Mask& by_frames,
                      const ImageF& by_aspect,
                      bool wants_blur,
                      ScanSlopes& slopes);

}  // namespace glint

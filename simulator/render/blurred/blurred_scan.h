// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/render/blurred/blurred_pixels.h"
#include "simulator/render/scan/scan.h"

namespace glint {

/// take_scan() of rough metal.
/// @param pixels  blurred_pixels() of that scan and tunnel
ScanResult take_blurred_scan(const BlurredPixels& pixels,
                             const TunnelSettings& tunnel,
                             const Sensor& sensor,
                             const ScanSettings& scan,
                             const FrameConsumer& consume = {});

}  // namespace glint

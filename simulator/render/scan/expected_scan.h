// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a scan's aspect image is on average over the sensor's noise, and how far a single scan
// strays: for scanning the same part many times at the price of one.
#pragma once

#include "core/image/image.h"
#include "simulator/render/footprint/footprints.h"
#include "simulator/sensor/sensor.h"

namespace glint {

struct ExpectedScan {
  ImageF aspect;     ///< mean of the frames, over all noise
  ImageF deviation;  ///< standard deviation of one scan's aspect by noise; 0 without noise
};

/// Every frame is rendered once, and each grey value is taken from the sensor's response to its
/// radiance, clipping and rounding included.
ExpectedScan expected_scan(const Footprints& footprints, const SensorSettings& settings);

}  // namespace glint

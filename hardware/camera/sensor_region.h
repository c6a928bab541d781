// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "hardware/camera/aravis.h"
#include "hardware/camera/camera.h"

namespace glint::aravis {

/// Sets what is read of the sensor; empty: all of it, in pixels as the camera bins them.
/// @throws ConfigError for a region that it does not take, IoError when it does not answer
void set_region(ArvCamera* camera, const std::optional<SensorRegion>& wanted);

}  // namespace glint::aravis

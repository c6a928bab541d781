// SPDX-License-Identifier: GPL-3.0-or-later
//
// Settings of a camera that change its pictures and that no configuration names: whatever somebody
// has set them to stays, unless the camera loses its power.
#pragma once

#include <string>

#include "hardware/camera/aravis.h"
#include "hardware/camera/camera.h"

namespace glint::aravis {

/// Sets a feature by its name to any text, blanks and quotes included; a command is executed.
/// @param key  that errors name
/// @throws ConfigError for a feature or a value that the camera does not know, IoError when it does
///         not answer
void set_feature(ArvDevice* device,
                 const std::string& name,
                 const std::string& value,
                 const std::string& key);

/// Those of the standard feature naming convention that this camera has and lets change: binning,
/// decimation, mirroring, black level, gamma, ... Not exposure, gain, region and format, which a
/// configuration sets.
NamedFeatures kept_features(ArvDevice* device);

/// Sets those that differ. @throws ConfigError for what the camera does not take, IoError when it
/// does not answer
void restore_features(ArvDevice* device, const NamedFeatures& features);

}  // namespace glint::aravis

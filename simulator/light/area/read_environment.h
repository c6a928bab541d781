// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include <Eigen/Core>

#include "simulator/light/area/environment.h"

namespace glint {

/// Reads red, green and blue (or grey) of any picture OpenImageIO knows; EXR and Radiance HDR are
/// linear, others are taken as if they were.
/// @throws IoError, ConfigError when a value is negative or no number
Environment read_environment(const std::filesystem::path& path, const Eigen::Array3f& scale);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace glint::test {

/// A cylinder of 12 mm under a tunnel, 48 x 32 pixels; the text ends in [lighting.tunnel].
inline const std::string kSmallTunnel = R"(schema = 1
[part]
shape = "cylinder"
length_mm = 12
radius_mm = 6
[camera]
width_px = 48
height_px = 32
object_pixel_mm = 0.2
working_distance_mm = 100
[metrics]
erosion_px = 1
[scan]
positions = 4
[lighting.tunnel]
)";

/// A random search of its homogeneity, without noise: ends in [budget].
inline const std::string kSmallTunnelStudy = kSmallTunnel + R"([sensor]
blur_px = 0
[variables]
"lighting.tunnel.duty" = { min = 0.3, max = 0.7 }
"lighting.tunnel.radius_mm" = { min = 60, max = 120 }
[objective]
maximise = "homogeneity.h_rms"
[search]
algorithm = "random"
[budget]
)";

}  // namespace glint::test

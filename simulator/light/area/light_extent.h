// SPDX-License-Identifier: GPL-3.0-or-later
//
// How large lights are: the box and the area of their luminous surfaces, and how many LEDs they
// have. What does not shine (housings, the far side of a light) is not known and does not count.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "simulator/light/area/build_lights.h"

namespace glint {

struct LightExtent {
  Eigen::AlignedBox3d box_mm;  ///< along the scene's axes; empty without a luminous surface
  double area_mm2 = 0.0;  ///< of all luminous surfaces; both faces of one that shines both ways
  int leds = 0;           ///< single LEDs of rings
};

/// The smallest box along the axes that holds the surface; bounds_mm() may be wider.
Eigen::AlignedBox3d exact_bounds_mm(const EmitterShape& shape);

/// Of all these lights together. An environment has neither box nor area and adds nothing.
/// @throws ConfigError, IoError as build_lights()
LightExtent extent_of(const std::vector<NamedLight>& lights,
                      const LightMounts& mounts,
                      const MeshLoader& load_mesh);

/// Of the wall of a tunnel, slot cut out, that stands with its middle at x = middle_x_mm.
/// @throws ConfigError as Tunnel
LightExtent extent_of(const TunnelSettings& tunnel, double middle_x_mm);

/// Both together.
LightExtent together(const LightExtent& a, const LightExtent& b);

}  // namespace glint

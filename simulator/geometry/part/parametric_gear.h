// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::geometry::part: the parametric spur gear.
#pragma once

#include "simulator/geometry/part/part.h"

namespace glint::parametric {

/// Radii and angles of a spur gear; see docs/theory/parts.md.
struct GearGeometry {
  double base_radius_mm = 0.0;
  double tip_radius_mm = 0.0;
  double root_radius_mm = 0.0;
  double half_tooth_rad = 0.0;  ///< half the angle of a tooth on the base circle
  double root_roll_rad = 0.0;   ///< roll angle where the involute starts
  double tip_roll_rad = 0.0;
  double half_tip_rad = 0.0;  ///< half the angle of a tooth at its tip, <= 0: pointed
  double half_gap_rad = 0.0;  ///< half the angle of the gap at the root, <= 0: none
};

GearGeometry gear_geometry(const GearSettings& settings);

void build_spur_gear(const GearSettings& settings, double chord_mm, Part& part);

}  // namespace glint::parametric

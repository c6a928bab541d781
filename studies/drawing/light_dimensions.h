// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "studies/drawing/light_section.h"

namespace glint {

/// What a dimension line says, between two points of the plane in mm: from the left, or upwards.
struct PlaneDimension {
  Eigen::Vector2d a_mm = Eigen::Vector2d::Zero();
  Eigen::Vector2d b_mm = Eigen::Vector2d::Zero();
  std::string words;
};

/// The sizes that a workshop needs of the lights in the plane, each once: diameters of rings (of
/// their edges as they are tilted), of the circles their LEDs stand on, of the rims and openings of
/// domes; length and width of bars, with their angle to the level; how far aside of the origin and
/// how high above it each light's middle is, of domes the middle of their rim. Circles whose axis
/// is not in the plane, and sides that are seen at an angle, have none.
std::vector<PlaneDimension> light_dimensions(const PhysicalScene& scene, const DrawingPlane& plane);

}  // namespace glint

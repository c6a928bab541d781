// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::geometry::part: the parametric shapes but the gear.
#pragma once

#include "simulator/geometry/part/part.h"

namespace glint::parametric {

void build_strip(const PartSettings& settings, Part& part);
void build_plate(const PartSettings& settings, Part& part);
void build_sphere_cap(const PartSettings& settings, Part& part);
void build_cylinder(const PartSettings& settings, Part& part);

}  // namespace glint::parametric

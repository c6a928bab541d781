// SPDX-License-Identifier: GPL-3.0-or-later
//
// The cheapest realisation of a defect that keeps the picture right: normals alone, a displaced
// mesh, or an imprint (docs/theory/imprint.md, "Which realisation").
#pragma once

#include "defects/definition/defect.h"
#include "studies/definition/scene.h"

namespace glint {

/// What the normals alone get wrong in the picture of a defect, as a share of its contrast: its
/// places move by the height times the tangent of the viewing angle, and light that leaves from a
/// steep flank meets the defect again.
/// @param view_rad        between the surface's normal and the ray to the camera, in [0, pi / 2)
/// @param light_mm        distance from the surface to the light, > 0
double normal_error(const Defect& defect, double view_rad, double light_mm);

/// Never Realisation::kAuto.
Realisation cheapest_realisation(const Defect& defect,
                                 const DefectGroup& group,
                                 const SceneSettings& scene);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/material/local.h"

namespace glint {

/// The diffuse lobe that returns what a model loses: with A(v) the share of light from v that the
/// model returns on a white surface, (1 - A(viewer)) (1 - A(light)) / (pi (1 - average A)).
/// Together they return everything, and stay reciprocal. Source: C. Kulla and A. Conty, "Revisiting
/// physically based shading at Imageworks", SIGGRAPH 2017 course notes.
/// @return  BRDF [1/sr], of a white surface
inline double compensation_brdf(double viewer_albedo, double light_albedo, double average_albedo) {
  constexpr double kNothingLost = 1e-9;
  const double lost = 1.0 - average_albedo;
  return lost > kNothingLost ? (1.0 - viewer_albedo) * (1.0 - light_albedo) / (kPi * lost) : 0.0;
}

/// The colour of that light, which has met the surface at least twice: F^2 A / (1 - F (1 - A)).
/// 1 for white. Source: S. Hill, "A multi-faceted exploration, part 3", 2018.
/// @param reflectance  average of the surface's Fresnel or colour
inline Colour compensation_colour(const Colour& reflectance, double average_albedo) {
  return reflectance * reflectance * average_albedo /
         (1.0 - reflectance * (1.0 - average_albedo)).max(1e-12);
}

}  // namespace glint

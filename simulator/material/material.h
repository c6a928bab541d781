// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a surface does with light: a closed set of plain structs behind one set of functions.
//
//   evaluate(material, to_viewer, to_light)   BRDF times cosine, and the density of sample()
//   sample(material, to_viewer, random)       a direction the light comes from, and its weight
//
// Directions are local (local.h): unit vectors away from the surface, z = normal, x = tangent. The
// surface is opaque: from behind, or with light from behind, all is black. Everything here is
// reciprocal, returns no more than it receives, and is shared between threads freely. One suite of
// tests runs over all of them (tests/simulator/material/conformance_test.cpp).
#pragma once

#include <variant>

#include "simulator/material/coated.h"
#include "simulator/material/conductor.h"
#include "simulator/material/mirror.h"
#include "simulator/material/rough_diffuse.h"

namespace glint {

using Material = std::variant<Mirror, Conductor, RoughDiffuse, Coated>;

Reflection evaluate(const Material& material,
                    const LocalDirection& to_viewer,
                    const LocalDirection& to_light);

/// Empty: the chosen path ends here. Those lost samples count as black ones.
std::optional<ReflectedSample> sample(const Material& material,
                                      const LocalDirection& to_viewer,
                                      const RandomTriple& random);

/// With which sample() chooses a direction [1/sr]; its integral is the share of samples that are
/// neither lost nor a mirror's.
double density(const Material& material,
               const LocalDirection& to_viewer,
               const LocalDirection& to_light);

/// Factors that a texture gives at one point.
struct Texel {
  Colour colour = Colour::Ones();  ///< of all light from below a coat, in [0, 1]
  double roughness = 1.0;          ///< of the roughness, > 0; widths grow with its square
};

/// The material at that point. Widths that leave the range its table of albedos was made for keep
/// the table's nearest one. A coat's tables stay those of the plain base.
Material textured(const Material& material, const Texel& texel);

}  // namespace glint

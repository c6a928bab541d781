// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/material/fresnel.h"
#include "simulator/material/ggx_albedo.h"
#include "simulator/material/reflection.h"

namespace glint {

/// Rough metal: GGX microfacets with height-correlated masking, sampled by visible normals, plus
/// the light that is reflected several times between them (multiple_scattering.h).
struct Conductor {
  GgxAlpha<double> alpha;
  Fresnel fresnel;
  Colour tint = Colour::Ones();       ///< factor of a texture, in [0, 1]
  const GgxAlbedo* albedo = nullptr;  ///< of these widths; null: nothing is added back. Not owned
  double albedo_scale = 1.0;          ///< alpha over the table's lowest widths
};

Reflection evaluate(const Conductor& metal,
                    const LocalDirection& to_viewer,
                    const LocalDirection& to_light);

/// Empty where the chosen facet reflects into the surface, or the viewer stands behind it.
std::optional<ReflectedSample> sample(const Conductor& metal,
                                      const LocalDirection& to_viewer,
                                      const RandomTriple& random);

}  // namespace glint

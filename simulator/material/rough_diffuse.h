// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/material/reflection.h"

namespace glint {

/// Matt surfaces, from Lambert's (roughness 0) to blasted or powder-coated ones (1): the
/// energy-preserving Oren-Nayar model.
/// Source: J. Portsmouth, P. Kutz, S. Hill, "EON: a practical energy-preserving rough diffuse
/// BRDF", arXiv 2410.18026, 2024; with the exact albedo.
struct RoughDiffuse {
  Colour colour = Colour::Ones();  ///< in [0, 1]
  double roughness = 0.0;          ///< in [0, 1]
  Colour tint = Colour::Ones();    ///< factor of a texture, in [0, 1]
};

Reflection evaluate(const RoughDiffuse& matt,
                    const LocalDirection& to_viewer,
                    const LocalDirection& to_light);

/// With the density cosine / pi.
std::optional<ReflectedSample> sample(const RoughDiffuse& matt,
                                      const LocalDirection& to_viewer,
                                      const RandomTriple& random);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/config/keys.h"
#include "simulator/material/material.h"

namespace glint {

/// Keys of [material.pattern]: the concentric marks of the second seed's gear (its equation 2),
///
///     v(x, y) = sqrt((x + c)^2 + (y + c)^2) mod d,   c = S(r mod 1),   r = sqrt(x^2 + y^2),
///
/// S the smoothstep 3 t^2 - 2 t^3, with x and y in `unit_mm` across the axis of [material.lay]. The
/// seed multiplies the metal's colour with v; that is colour = 1 and scaled = false.
///
/// Source: D. Bosnar et al., image synthesis pipeline for surface inspection, 2020, equation 2.
struct PatternSettings {
  enum class Kind { kNone, kConcentric };

  Kind kind = Kind::kNone;
  double density = 1.0;    ///< d
  double unit_mm = 1.0;    ///< length of 1 in the equation; the seed does not say
  double colour = 1.0;     ///< 0: none; 1: the colour is multiplied with v
  double roughness = 0.0;  ///< the roughness varies by plus and minus this share of itself
  bool scaled = false;     ///< v / d instead of v: between 0 and 1 for any d
};

void visit_keys(KeyVisitor& keys, PatternSettings& settings);

/// v(x, y), in [0, density). @param density  > 0
double concentric_value(double x, double y, double density);

/// @param at_mm  point in the plane of the pattern (LayPlane::at)
Texel texel_at(const PatternSettings& settings, const Eigen::Vector2d& at_mm);

/// Factors of roughness that texels can have: [1 - roughness, 1 + roughness], or 1.
Interval roughness_factors(const PatternSettings& settings);

}  // namespace glint

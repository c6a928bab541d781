// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/material/fresnel.h"
#include "simulator/material/reflection.h"

namespace glint {

/// A perfectly smooth metal; with constant Fresnel 1, the perfect mirror of the fringe tunnels.
struct Mirror {
  Fresnel fresnel;
  Colour tint = Colour::Ones();  ///< factor of a texture, in [0, 1]
};

/// Nothing: a mirror's light comes from one direction only, which sample() gives.
inline Reflection evaluate(const Mirror&, const LocalDirection&, const LocalDirection&) {
  return {};
}

inline std::optional<ReflectedSample> sample(const Mirror& mirror,
                                             const LocalDirection& to_viewer,
                                             const RandomTriple&) {
  if (!is_above(to_viewer)) {
    return std::nullopt;
  }
  return ReflectedSample{.to_light = {-to_viewer.x, -to_viewer.y, to_viewer.z},
                         .weight = reflectance(mirror.fresnel, to_viewer.z) * mirror.tint,
                         .is_mirror = true};
}

}  // namespace glint

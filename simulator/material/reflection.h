// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

#include "simulator/material/local.h"

namespace glint {

/// What a material does with light from one direction towards a viewer.
struct Reflection {
  Colour value = Colour::Zero();  ///< BRDF times cosine of the light's direction [1/sr]
  double density = 0.0;           ///< with which sample() chooses that direction [1/sr]
};

/// A direction chosen by sample().
struct ReflectedSample {
  LocalDirection to_light;
  Colour weight = Colour::Zero();  ///< value / density; of a mirror, its reflectance over the share
                                   ///< of samples that take it
  double density = 0.0;            ///< as in Reflection; 0 for a mirror's direction
  bool is_mirror = false;          ///< evaluate() knows nothing of this direction
};

/// Three numbers in [0, 1): two choose the direction, the third among ways to reflect.
using RandomTriple = std::array<double, 3>;

/// Closer than this to the surface everything is black; nothing then divides by too small a number.
inline constexpr double kMinCosine = 1e-12;

inline bool is_above(const LocalDirection& direction) {
  return direction.z > kMinCosine;
}

/// Largest of the three: how much a colour can matter.
inline double strength(const Colour& colour) {
  return colour.maxCoeff();
}

}  // namespace glint

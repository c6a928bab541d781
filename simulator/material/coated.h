// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <variant>

#include "simulator/material/conductor.h"
#include "simulator/material/direction_table.h"
#include "simulator/material/mirror.h"
#include "simulator/material/rough_diffuse.h"

namespace glint {

/// What a coat can lie on.
using BaseMaterial = std::variant<Mirror, Conductor, RoughDiffuse>;

/// A clear lacquer, oil film or anodised layer; its thickness does not matter (no interference).
struct Coat {
  double index = 1.5;                     ///< refractive index, > 1
  double alpha = 0.0;                     ///< GGX width of its upper face; 0: smooth
  Colour transmittance = Colour::Ones();  ///< once down and up along the normal, in (0, 1]
};

/// Shares of light, by direction, that evaluating a coated material needs; of the white base.
class CoatTables {
 public:
  CoatTables(const Coat& coat, const BaseMaterial& base);

  /// Reflected by the coat's upper face.
  double face(const Coat& coat, const LocalDirection& direction) const;

  /// Returned by coat and base before what they lose to each other is added back.
  const DirectionTable& layered() const { return layered_; }

  /// For the light that layered() lacks.
  const CompensationSampler& losses() const { return losses_; }

 private:
  DirectionTable face_;
  DirectionTable layered_;
  CompensationSampler losses_;
};

/// A dielectric coat over a base. An approximation that never returns more than it receives, and
/// everything when nothing absorbs:
///
///   f = f_coat + absorb (1 - max(C(viewer), C(light))) f_base + absorb f_compensation
///
/// C is the share reflected by the coat's upper face, so what passes it downwards and upwards is
/// bounded by either direction alone; absorb = transmittance^((1/c_viewer + 1/c_light) / 2) with
/// the cosines c inside the coat; f_compensation (multiple_scattering.h) returns the light held
/// between coat and base. Left out: the base is asked for the directions outside, although the coat
/// bends light.
struct Coated {
  Coat coat;
  BaseMaterial base;
  const CoatTables* tables = nullptr;  ///< of this coat and base; never null. Not owned
  Colour tint = Colour::Ones();        ///< factor of a texture on the base, in [0, 1]
};

Reflection evaluate(const Coated& coated,
                    const LocalDirection& to_viewer,
                    const LocalDirection& to_light);

std::optional<ReflectedSample> sample(const Coated& coated,
                                      const LocalDirection& to_viewer,
                                      const RandomTriple& random);

}  // namespace glint

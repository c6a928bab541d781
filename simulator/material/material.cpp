// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/material.h"

namespace glint {
namespace {

void apply(Mirror& mirror, const Texel& texel) {
  mirror.tint *= texel.colour;
}

void apply(Conductor& metal, const Texel& texel) {
  const double factor = texel.roughness * texel.roughness;
  metal.alpha = {std::max(kMinAlpha, metal.alpha.x * factor),
                 std::max(kMinAlpha, metal.alpha.y * factor)};
  metal.albedo_scale *= factor;
  metal.tint *= texel.colour;
}

void apply(RoughDiffuse& matt, const Texel& texel) {
  matt.roughness = std::min(1.0, matt.roughness * texel.roughness);
  matt.tint *= texel.colour;
}

void apply(Coated& coated, const Texel& texel) {
  std::visit([&](auto& base) { apply(base, {.roughness = texel.roughness}); }, coated.base);
  coated.tint *= texel.colour;
}

}  // namespace

Reflection evaluate(const Material& material,
                    const LocalDirection& to_viewer,
                    const LocalDirection& to_light) {
  return std::visit([&](const auto& m) { return evaluate(m, to_viewer, to_light); }, material);
}

std::optional<ReflectedSample> sample(const Material& material,
                                      const LocalDirection& to_viewer,
                                      const RandomTriple& random) {
  return std::visit([&](const auto& m) { return sample(m, to_viewer, random); }, material);
}

double density(const Material& material,
               const LocalDirection& to_viewer,
               const LocalDirection& to_light) {
  return evaluate(material, to_viewer, to_light).density;
}

Material textured(const Material& material, const Texel& texel) {
  Material result = material;
  std::visit([&](auto& m) { apply(m, texel); }, result);
  return result;
}

}  // namespace glint

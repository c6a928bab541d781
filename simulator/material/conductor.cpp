// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two lobes: one reflection by microfacets, drawn by the normals that the viewer sees (ggx.h), and
// what several reflections add back, drawn by the light that is lost at each angle
// (compensation_sampler.h). A sample takes either lobe by its share of the light towards the viewer
// and is weighted with the density of both, so that no weight is large. Cost: a table is read once
// for each of the two directions. docs/theory/materials.md
#include "simulator/material/conductor.h"

#include "simulator/material/multiple_scattering.h"

namespace glint {
namespace {

/// What the lobe of several reflections needs to know of the viewer's direction.
struct Compensation {
  Colour colour = Colour::Zero();
  double viewer_albedo = 1.0;
  double average = 1.0;
  double share = 0.0;  ///< of samples that go to this lobe
  const CompensationSampler* losses = nullptr;
};

Compensation compensation_of(const Conductor& metal, const LocalDirection& to_viewer) {
  if (metal.albedo == nullptr) {
    return {};
  }
  Compensation lobe = {.viewer_albedo = metal.albedo->at(to_viewer, metal.albedo_scale),
                       .average = metal.albedo->average(metal.albedo_scale),
                       .losses = &metal.albedo->losses(metal.albedo_scale)};
  lobe.colour = compensation_colour(metal.fresnel.average, lobe.average);
  const double here = strength(lobe.colour) * std::max(0.0, 1.0 - lobe.viewer_albedo);
  const double single = strength(metal.fresnel.average) * lobe.viewer_albedo;
  lobe.share = here > 0.0 ? here / (here + single) : 0.0;
  return lobe;
}

Reflection evaluate_with(const Conductor& metal,
                         const Compensation& lobe,
                         const LocalDirection& to_viewer,
                         const LocalDirection& to_light) {
  const LocalDirection normal = half_vector(to_viewer, to_light);
  const double distribution = ggx_distribution(metal.alpha, normal);
  const double single =
      distribution * ggx_visibility(metal.alpha, to_viewer, to_light) * to_light.z;
  Reflection result = {.value = reflectance(metal.fresnel, dot(to_light, normal)) * single,
                       .density = (1.0 - lobe.share) * ggx_density(metal.alpha, to_viewer, normal)};
  if (lobe.share > 0.0) {
    const double light_albedo = metal.albedo->at(to_light, metal.albedo_scale);
    const double brdf = compensation_brdf(lobe.viewer_albedo, light_albedo, lobe.average);
    result.value += lobe.colour * (std::max(0.0, brdf) * to_light.z);
    result.density += lobe.share * lobe.losses->density(to_light);
  }
  result.value *= metal.tint;
  return result;
}

}  // namespace

Reflection evaluate(const Conductor& metal,
                    const LocalDirection& to_viewer,
                    const LocalDirection& to_light) {
  if (!(is_above(to_viewer) && is_above(to_light))) {
    return {};
  }
  return evaluate_with(metal, compensation_of(metal, to_viewer), to_viewer, to_light);
}

std::optional<ReflectedSample> sample(const Conductor& metal,
                                      const LocalDirection& to_viewer,
                                      const RandomTriple& random) {
  if (!is_above(to_viewer)) {
    return std::nullopt;
  }
  const Compensation lobe = compensation_of(metal, to_viewer);
  const LocalDirection to_light =
      random[2] < lobe.share
          ? lobe.losses->sample(random[0], random[1])
          : reflect(to_viewer, ggx_sample_normal(metal.alpha, to_viewer, random[0], random[1]));
  if (!is_above(to_light)) {
    return std::nullopt;
  }
  const Reflection result = evaluate_with(metal, lobe, to_viewer, to_light);
  if (!(result.density > 0.0)) {
    return std::nullopt;
  }
  return ReflectedSample{
      .to_light = to_light, .weight = result.value / result.density, .density = result.density};
}

}  // namespace glint

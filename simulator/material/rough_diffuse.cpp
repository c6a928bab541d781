// SPDX-License-Identifier: GPL-3.0-or-later
//
// EON in closed form: the Fujii form of Oren-Nayar, whose albedo is known exactly, and a second
// term in (1 - albedo(viewer)) (1 - albedo(light)) that returns what it lacks, coloured once for
// each further reflection. Nothing is tabulated; cost: one acos a direction. Sources beside the
// struct; docs/theory/materials.md.
#include "simulator/material/rough_diffuse.h"

#include "simulator/material/multiple_scattering.h"

namespace glint {
namespace {

constexpr double kSlope = 0.5 - 2.0 / (3.0 * kPi);
constexpr double kAverageSlope = 2.0 / 3.0 - 28.0 / (15.0 * kPi);

/// Share of light that one reflection returns from a white surface.
double single_albedo(double cosine, double roughness) {
  const double mu = std::min(cosine, 1.0);
  const double s = std::sqrt(1.0 - mu * mu);
  // (s / mu) (1 - s^3) without the division by a small mu: 1 - s^3 = (1 - s^2) (1 + s + s^2) / (1 +
  // s).
  const double tail = s * mu * (1.0 + s + s * s) / (1.0 + s);
  const double g = s * (std::acos(mu) - s * mu) + 2.0 / 3.0 * (tail - s);
  return (1.0 + roughness * g / kPi) / (1.0 + kSlope * roughness);
}

}  // namespace

Reflection evaluate(const RoughDiffuse& matt,
                    const LocalDirection& to_viewer,
                    const LocalDirection& to_light) {
  if (!(is_above(to_viewer) && is_above(to_light))) {
    return {};
  }
  const double r = matt.roughness;
  const double s = dot(to_viewer, to_light) - to_viewer.z * to_light.z;
  const double s_over_t = s > 0.0 ? s / std::max(to_viewer.z, to_light.z) : s;
  const double scale = 1.0 / (1.0 + kSlope * r);
  const double average = scale * (1.0 + kAverageSlope * r);
  Colour brdf = matt.colour * (scale * (1.0 + r * s_over_t) / kPi);
  brdf += compensation_colour(matt.colour, average) *
          compensation_brdf(single_albedo(to_viewer.z, r), single_albedo(to_light.z, r), average);
  return {.value = brdf * matt.tint * to_light.z, .density = to_light.z / kPi};
}

std::optional<ReflectedSample> sample(const RoughDiffuse& matt,
                                      const LocalDirection& to_viewer,
                                      const RandomTriple& random) {
  const LocalDirection to_light = sample_cosine(random[0], random[1]);
  const Reflection result = evaluate(matt, to_viewer, to_light);
  if (!(result.density > 0.0)) {
    return std::nullopt;
  }
  return ReflectedSample{
      .to_light = to_light, .weight = result.value / result.density, .density = result.density};
}

}  // namespace glint

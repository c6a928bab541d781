// SPDX-License-Identifier: GPL-3.0-or-later
//
// A base under a clear coat by albedo scaling: what a direction's light loses at the coat's face,
// the base cannot return, so its lobe is scaled by 1 - max(C(viewer), C(light)), which keeps it
// reciprocal. What is trapped between coat and base comes back as a third lobe after Kulla and
// Conty (multiple_scattering.h). The shares that this needs depend on the direction alone: they are
// integrated by quadrature over 24 to 80 nodes an axis into tables (direction_table.h) once a
// material, 10 to 170 ms; a sample reads them. Model and limits: docs/theory/materials.md.
#include "simulator/material/coated.h"

#include <functional>

#include "simulator/material/multiple_scattering.h"

namespace glint {
namespace {

/// Nodes along either axis for integrals over directions: of smooth functions, of a diffuse base
/// under a coat's face, of microfacets, and of microfacets with unequal widths (ggx_albedo.cpp).
constexpr int kSmoothNodes = 24;
constexpr int kMattNodes = 64;
constexpr int kFacetNodes = 80;
constexpr int kUnequalNodes = 40;

bool is_smooth(const Coat& coat) {
  return !(coat.alpha > 0.0);
}

GgxAlpha<double> alpha_of(const Coat& coat) {
  const double alpha = std::max(kMinAlpha, coat.alpha);
  return {alpha, alpha};
}

/// The mean of a function of two numbers in [0, 1), the first of which is an angle.
template <class Function>
double mean_over_square(const Quadrature& rule, const Function& function) {
  const double step = 1.0 / static_cast<double>(rule.nodes.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    for (std::size_t a = 0; a < rule.nodes.size(); ++a) {
      sum +=
          rule.weights[i] * step * function((static_cast<double>(a) + 0.5) * step, rule.nodes[i]);
    }
  }
  return sum;
}

DirectionTable face_table(const Coat& coat) {
  const Quadrature rule = gauss_legendre(kFacetNodes);
  const GgxAlpha<double> alpha = alpha_of(coat);
  return {alpha, [&](const LocalDirection& to_viewer) {
            if (is_smooth(coat)) {
              return dielectric_reflectance(coat.index, to_viewer.z);
            }
            return mean_over_square(rule, [&](double u, double v) {
              const LocalDirection normal = ggx_sample_normal(alpha, to_viewer, u, v);
              const LocalDirection to_light = reflect(to_viewer, normal);
              return to_light.z > 0.0
                         ? ggx_weight(alpha, to_viewer, to_light) *
                               dielectric_reflectance(coat.index, dot(to_light, normal))
                         : 0.0;
            });
          }};
}

/// The base as if it absorbed nothing.
BaseMaterial white(const BaseMaterial& base) {
  if (const auto* matt = std::get_if<RoughDiffuse>(&base)) {
    return RoughDiffuse{.roughness = matt->roughness};
  }
  if (const auto* metal = std::get_if<Conductor>(&base)) {
    Conductor result = *metal;
    result.fresnel = constant_fresnel(Colour::Ones());
    result.tint = Colour::Ones();
    return result;
  }
  return Mirror{};
}

/// A base without the light reflected several times, so that one way to reflect is left and two
/// numbers choose its direction.
BaseMaterial single(const BaseMaterial& base) {
  BaseMaterial result = base;
  if (auto* metal = std::get_if<Conductor>(&result)) {
    metal->albedo = nullptr;
  }
  return result;
}

/// Widths by which the nodes of the table of a base are placed.
GgxAlpha<double> table_alpha(const Coat& coat, const BaseMaterial& base) {
  if (const auto* metal = std::get_if<Conductor>(&base)) {
    return metal->alpha;
  }
  return is_smooth(coat) ? GgxAlpha<double>{0.5, 0.5} : alpha_of(coat);
}

double table_width(const Coat& coat, const BaseMaterial& base) {
  const GgxAlpha<double> alpha = table_alpha(coat, base);
  return std::sqrt(alpha.x * alpha.y);
}

Quadrature rule_for(const BaseMaterial& base) {
  const auto* metal = std::get_if<Conductor>(&base);
  if (metal == nullptr) {
    return gauss_legendre(kMattNodes);
  }
  return gauss_legendre(metal->alpha.x == metal->alpha.y ? kFacetNodes : kUnequalNodes);
}

std::optional<ReflectedSample> sample_base(const BaseMaterial& base,
                                           const LocalDirection& to_viewer,
                                           const RandomTriple& random) {
  return std::visit([&](const auto& b) { return sample(b, to_viewer, random); }, base);
}

Reflection evaluate_base(const BaseMaterial& base,
                         const LocalDirection& to_viewer,
                         const LocalDirection& to_light) {
  return std::visit([&](const auto& b) { return evaluate(b, to_viewer, to_light); }, base);
}

/// Average reflectance, for light that meets the base several times.
Colour average_of(const BaseMaterial& base) {
  if (const auto* matt = std::get_if<RoughDiffuse>(&base)) {
    return matt->colour * matt->tint;
  }
  if (const auto* metal = std::get_if<Conductor>(&base)) {
    return metal->fresnel.average * metal->tint;
  }
  const auto& mirror = std::get<Mirror>(base);
  return mirror.fresnel.average * mirror.tint;
}

/// What a white conductor adds for several reflections, towards the viewer and through the face.
double compensation_through(const Conductor& metal,
                            const Quadrature& rule,
                            const LocalDirection& to_viewer,
                            const std::function<double(const LocalDirection&)>& passes) {
  if (metal.albedo == nullptr) {
    return 0.0;
  }
  const double scale = metal.albedo_scale;
  const double viewer = metal.albedo->at(to_viewer, scale);
  const double average = metal.albedo->average(scale);
  return mean_over_square(rule, [&](double u, double v) {
    const LocalDirection to_light = sample_cosine(u, v);
    const double light = metal.albedo->at(to_light, scale);
    return kPi * compensation_brdf(viewer, light, average) * passes(to_light);
  });
}

DirectionTable layered_table(const Coat& coat, const BaseMaterial& base, const CoatTables& tables) {
  const BaseMaterial whole = white(base);
  const BaseMaterial first = single(whole);
  const Quadrature rule = rule_for(base);
  const Quadrature smooth = gauss_legendre(kSmoothNodes);
  return DirectionTable(table_alpha(coat, base), [&](const LocalDirection& to_viewer) {
    const double face = tables.face(coat, to_viewer);
    const auto passes = [&](const LocalDirection& to_light) {
      return 1.0 - std::max(face, tables.face(coat, to_light));
    };
    double sum = face + mean_over_square(rule, [&](double u, double v) {
                   const auto light = sample_base(first, to_viewer, {u, v, 0.5});
                   return light ? light->weight[0] * passes(light->to_light) : 0.0;
                 });
    if (const auto* metal = std::get_if<Conductor>(&whole)) {
      sum += compensation_through(*metal, smooth, to_viewer, passes);
    }
    return to_viewer.z > 0.0 ? std::min(1.0, sum) : 1.0;
  });
}

/// The ways a coated surface reflects, seen from one direction.
struct Lobes {
  double face = 0.0;     ///< reflected by the coat's upper face
  double layered = 0.0;  ///< CoatTables::layered
  Colour compensation_colour = Colour::Zero();
  double to_face = 0.0;  ///< shares of samples
  double to_base = 0.0;
  double to_compensation = 0.0;
};

Lobes lobes_of(const Coated& coated, const LocalDirection& to_viewer) {
  Lobes lobes = {.face = coated.tables->face(coated.coat, to_viewer),
                 .layered = coated.tables->layered().at(to_viewer)};
  const Colour base = average_of(coated.base) * coated.tint;
  lobes.compensation_colour = compensation_colour(base, coated.tables->layered().average());
  lobes.to_face = lobes.face;
  lobes.to_base = (1.0 - lobes.face) * strength(base);
  lobes.to_compensation = std::max(0.0, 1.0 - lobes.layered) * strength(lobes.compensation_colour);
  const double sum = lobes.to_face + lobes.to_base + lobes.to_compensation;
  lobes.to_face /= sum;
  lobes.to_base /= sum;
  lobes.to_compensation /= sum;
  return lobes;
}

/// What the coat leaves of light that goes in and out along two directions.
Colour absorbed(const Coat& coat, const LocalDirection& a, const LocalDirection& b) {
  const double path =
      0.5 / refracted_cosine(coat.index, a.z) + 0.5 / refracted_cosine(coat.index, b.z);
  return coat.transmittance.pow(path);
}

double passes(const Coated& coated, const Lobes& lobes, const LocalDirection& to_light) {
  return 1.0 - std::max(lobes.face, coated.tables->face(coated.coat, to_light));
}

Reflection evaluate_face(const Coat& coat,
                         const LocalDirection& to_viewer,
                         const LocalDirection& to_light) {
  if (is_smooth(coat)) {
    return {};
  }
  const GgxAlpha<double> alpha = alpha_of(coat);
  const LocalDirection normal = half_vector(to_viewer, to_light);
  const double value = ggx_distribution(alpha, normal) *
                       ggx_visibility(alpha, to_viewer, to_light) * to_light.z *
                       dielectric_reflectance(coat.index, dot(to_light, normal));
  return {.value = Colour::Constant(value), .density = ggx_density(alpha, to_viewer, normal)};
}

Reflection evaluate_with(const Coated& coated,
                         const Lobes& lobes,
                         const LocalDirection& to_viewer,
                         const LocalDirection& to_light) {
  const Reflection face = evaluate_face(coated.coat, to_viewer, to_light);
  const Reflection base = evaluate_base(coated.base, to_viewer, to_light);
  const DirectionTable& layered = coated.tables->layered();
  const double compensation = std::max(
      0.0, compensation_brdf(lobes.layered, layered.at(to_light), layered.average()) * to_light.z);
  const Colour below = base.value * coated.tint * passes(coated, lobes, to_light) +
                       lobes.compensation_colour * compensation;
  return {.value = face.value + below * absorbed(coated.coat, to_viewer, to_light),
          .density = lobes.to_face * face.density + lobes.to_base * base.density +
                     lobes.to_compensation * coated.tables->losses().density(to_light)};
}

/// The mirror direction at a smooth coat's face.
ReflectedSample sample_smooth_face(const Lobes& lobes, const LocalDirection& to_viewer) {
  return {.to_light = {-to_viewer.x, -to_viewer.y, to_viewer.z},
          .weight = Colour::Constant(lobes.face / lobes.to_face),
          .is_mirror = true};
}

LocalDirection sample_rough_face(const Coat& coat,
                                 const LocalDirection& to_viewer,
                                 const RandomTriple& random) {
  return reflect(to_viewer, ggx_sample_normal(alpha_of(coat), to_viewer, random[0], random[1]));
}

std::optional<ReflectedSample> completed(const Coated& coated,
                                         const Lobes& lobes,
                                         const LocalDirection& to_viewer,
                                         const LocalDirection& to_light) {
  if (!is_above(to_light)) {
    return std::nullopt;
  }
  const Reflection result = evaluate_with(coated, lobes, to_viewer, to_light);
  if (!(result.density > 0.0)) {
    return std::nullopt;
  }
  return ReflectedSample{
      .to_light = to_light, .weight = result.value / result.density, .density = result.density};
}

}  // namespace

CoatTables::CoatTables(const Coat& coat, const BaseMaterial& base)
    : face_(face_table(coat)),
      layered_(layered_table(coat, base, *this)),
      losses_(layered_, table_width(coat, base)) {}

double CoatTables::face(const Coat& coat, const LocalDirection& direction) const {
  return is_smooth(coat) ? dielectric_reflectance(coat.index, direction.z) : face_.at(direction);
}

Reflection evaluate(const Coated& coated,
                    const LocalDirection& to_viewer,
                    const LocalDirection& to_light) {
  if (!(is_above(to_viewer) && is_above(to_light))) {
    return {};
  }
  return evaluate_with(coated, lobes_of(coated, to_viewer), to_viewer, to_light);
}

std::optional<ReflectedSample> sample(const Coated& coated,
                                      const LocalDirection& to_viewer,
                                      const RandomTriple& random) {
  if (!is_above(to_viewer)) {
    return std::nullopt;
  }
  const Lobes lobes = lobes_of(coated, to_viewer);
  if (random[2] < lobes.to_face) {
    if (is_smooth(coated.coat)) {
      return sample_smooth_face(lobes, to_viewer);
    }
    return completed(coated, lobes, to_viewer, sample_rough_face(coated.coat, to_viewer, random));
  }
  if (random[2] >= lobes.to_face + lobes.to_base) {
    return completed(
        coated, lobes, to_viewer, coated.tables->losses().sample(random[0], random[1]));
  }
  const RandomTriple rest = {random[0], random[1], (random[2] - lobes.to_face) / lobes.to_base};
  std::optional<ReflectedSample> base = sample_base(coated.base, to_viewer, rest);
  if (!base || !base->is_mirror) {
    return base ? completed(coated, lobes, to_viewer, base->to_light) : std::nullopt;
  }
  base->weight *= coated.tint * passes(coated, lobes, base->to_light) / lobes.to_base *
                  absorbed(coated.coat, to_viewer, base->to_light);
  return base;
}

}  // namespace glint

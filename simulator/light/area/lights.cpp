// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/lights.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "simulator/light/area/shape_sampling.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Distances nearer than this share to a sampled one are the sampled surface itself.
constexpr double kSameDistance = 1e-9;
constexpr double kFarField = 5.0;

/// The share of samples that go to the environment at a point, from both irradiances.
double environment_share(const Lights& lights, const Vector3d& point_mm) {
  if (!lights.environment) {
    return 0.0;
  }
  const double from_afar = kPi * lights.environment->mean_radiance();
  const double sum = from_afar + lights.tree.estimate_w_m2(lights.emitters, point_mm);
  return sum > 0.0 ? from_afar / sum : 0.0;
}

/// A tunnel's emitters have many groups.
int group_of(const Lights& lights, int index, const Vector3d& point_mm) {
  return lights.wall && lights.wall->has(index)
             ? lights.wall->group_at(index, point_mm)
             : lights.emitters[static_cast<std::size_t>(index)].group;
}

const Emitter& emitter_at(const Lights& lights, int index) {
  return lights.emitters[static_cast<std::size_t>(index)];
}

std::optional<LightSample> sample_environment(const Lights& lights,
                                              double share,
                                              double u,
                                              double v) {
  const auto drawn = lights.environment->sample(u, v);
  if (!(drawn.density > 0.0)) {
    return std::nullopt;
  }
  return LightSample{.direction = lights.environment_frame.global(drawn.direction),
                     .radiance = drawn.radiance,
                     .density = share * drawn.density,
                     .emitter = kEnvironment,
                     .group = lights.environment_group};
}

std::optional<LightSample> sample_emitters(
    const Lights& lights, const Vector3d& point_mm, double share, double u, double v) {
  const auto choice = lights.tree.choose(lights.emitters, point_mm, u);
  if (!choice) {
    return std::nullopt;
  }
  const Emitter& emitter = emitter_at(lights, choice->emitter);
  const auto to = sample_shape(emitter.shape, point_mm, choice->u, v);
  if (!to) {
    return std::nullopt;
  }
  return LightSample{
      .direction = to->direction,
      .distance_mm = to->distance_mm,
      .radiance = emitted_radiance(emitter, lights.bodies, to->cosine, -to->direction),
      .density = share * choice->probability * to->density,
      .emitter = choice->emitter,
      .group = group_of(lights, choice->emitter, point_mm + to->distance_mm * to->direction)};
}

}  // namespace

std::optional<LightSample> sample_light(const Lights& lights,
                                        const Vector3d& point_mm,
                                        double u,
                                        double v) {
  const double share = environment_share(lights, point_mm);
  if (u < share) {
    return sample_environment(lights, share, u / share, v);
  }
  if (!(share < 1.0)) {
    return std::nullopt;
  }
  return sample_emitters(lights, point_mm, 1.0 - share, (u - share) / (1.0 - share), v);
}

std::optional<LightHit> hit_light(const Lights& lights, const Ray& ray, double max_mm) {
  if (const auto met = lights.tree.hit(lights.emitters, ray, max_mm)) {
    const Emitter& emitter = emitter_at(lights, met->emitter);
    const double cosine = met->crossing.cosine;
    return LightHit{
        .distance_mm = met->crossing.distance_mm,
        .cosine = cosine,
        .radiance = emitted_radiance(emitter, lights.bodies, cosine, -ray.direction),
        .emitter = met->emitter,
        .group = group_of(
            lights, met->emitter, ray.origin_mm + met->crossing.distance_mm * ray.direction)};
  }
  if (!lights.environment || std::isfinite(max_mm)) {
    return std::nullopt;
  }
  return LightHit{
      .radiance = lights.environment->radiance(lights.environment_frame.local(ray.direction)),
      .emitter = kEnvironment,
      .group = lights.environment_group};
}

double light_density(const Lights& lights, const Ray& ray, const LightHit& hit) {
  const double share = environment_share(lights, ray.origin_mm);
  if (hit.emitter == kEnvironment) {
    return share * lights.environment->density(lights.environment_frame.local(ray.direction));
  }
  if (!(hit.cosine > 0.0)) {
    return 0.0;
  }
  const double chosen = lights.tree.probability(lights.emitters, ray.origin_mm, hit.emitter);
  return (1.0 - share) * chosen *
         shape_density(emitter_at(lights, hit.emitter).shape,
                       ray.origin_mm,
                       {.distance_mm = hit.distance_mm, .cosine = hit.cosine});
}

bool is_occluded(const Lights& lights, const Vector3d& point_mm, const LightSample& sample) {
  const Ray ray = {.origin_mm = point_mm, .direction = sample.direction};
  return lights.tree.hit(lights.emitters, ray, sample.distance_mm * (1.0 - kSameDistance))
      .has_value();
}

std::vector<std::string> tilt_warnings(const Lights& lights) {
  std::vector<std::string> warnings;
  for (const IesBody& body : lights.bodies) {
    if (!body.table.has_tilt) {
      continue;
    }
    warnings.push_back(fmt::format(
        "{}: the table of TILT=INCLUDE (factors {:g} to {:g}) is not applied: the light "
        "shines as it was measured, however it is turned here",
        body.table.file,
        body.table.min_tilt_factor,
        body.table.max_tilt_factor));
  }
  return warnings;
}

std::vector<std::string> far_field_warnings(const Lights& lights,
                                            const std::vector<Vector3d>& points_mm) {
  std::vector<std::string> warnings;
  for (const IesBody& body : lights.bodies) {
    const double size = body.size_mm.maxCoeff();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vector3d& point : points_mm) {
      nearest = std::min(nearest, (point - body.frame.origin_mm).norm());
    }
    if (nearest < kFarField * size) {
      warnings.push_back(fmt::format(
          "{}: the light is {:.0f} mm wide and {:.0f} mm away; its intensities were measured from "
          "afar and hold from {:.0f} mm on",
          body.table.file,
          size,
          nearest,
          kFarField * size));
    }
  }
  return warnings;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points of metal under area lights, and their light summed without mercy.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/rng.h"
#include "simulator/light/area/lights.h"
#include "simulator/material/material_settings.h"
#include "simulator/render/direct/direct_light.h"
#include "simulator/render/path_tracing/packet_numbers.h"
#include "tests/simulator/render/path_tracing/path_bench.h"

namespace glint::direct_test {

using Eigen::Vector3d;

inline constexpr double kTolerance = 5e-4;

inline Lights lights_with(const std::vector<EmitterShape>& shapes, double exponent = 1.0) {
  Lights lights;
  lights.groups.push_back({.name = "light"});
  for (const EmitterShape& shape : shapes) {
    lights.emitters.push_back({.shape = shape, .exponent = exponent});
  }
  return lights;
}

/// A horizontal disc or annulus that shines down.
inline RingShape ring_above(double inner_mm, double outer_mm, const Vector3d& at_mm) {
  return {.frame = frame_around(at_mm, -Vector3d::UnitZ()),
          .middle_radius_mm = 0.5 * (inner_mm + outer_mm),
          .width_mm = outer_mm - inner_mm};
}

/// Seen at an angle from the normal z, from an azimuth.
inline DirectPoint point_seen(double incidence_rad, double azimuth_rad = 0.0) {
  return {.to_viewer = {std::sin(incidence_rad) * std::cos(azimuth_rad),
                        std::sin(incidence_rad) * std::sin(azimuth_rad),
                        std::cos(incidence_rad)}};
}

/// A metal with its tables.
struct Metal {
  SurfaceMaterial material;
  ConductorNumbers numbers;

  explicit Metal(const MaterialSettings& settings)
      : material(settings, path_test::kGreen_nm),
        numbers(conductor_numbers(material.plain()).value()) {}
};

/// By n x n places of equal area on each light, in double.
inline double summed_by_area(const Lights& lights,
                             const Material& metal,
                             const DirectPoint& point,
                             int n) {
  double sum = 0.0;
  for (const Emitter& emitter : lights.emitters) {
    const double area = area_mm2(emitter.shape) / (static_cast<double>(n) * n);
    for (int i = 0; i < n * n; ++i) {
      const int row = i / n;
      const ShapePoint place = point_on(emitter.shape, (i % n + 0.5) / n, (row + 0.5) / n);
      const Vector3d way = place.point_mm - point.point_mm;
      const Vector3d direction = way.normalized();
      const double cosine = -place.normal.dot(direction);
      if (cosine > 0.0 && point.side.dot(direction) > 0.0) {
        const Reflection towards =
            evaluate(metal, point.to_viewer, point.frame.to_local(direction));
        sum += towards.value[0] * static_cast<double>(emitter.radiance[0]) *
               std::pow(cosine, emitter.exponent) * area / way.squaredNorm();
      }
    }
  }
  return sum;
}

inline double direct_at(const Lights& lights,
                        const ConductorNumbers& metal,
                        const DirectPoint& point,
                        double tolerance = kTolerance) {
  const DirectLight light(lights, metal, 1, tolerance);
  DirectLight::Scratch scratch;
  std::vector<float> radiance(light.size());
  light.at(point, {}, scratch, radiance);
  return static_cast<double>(radiance[0]);
}

}  // namespace glint::direct_test

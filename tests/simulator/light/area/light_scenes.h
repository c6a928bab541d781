// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/rng.h"
#include "core/units.h"
#include "simulator/light/area/build_lights.h"

namespace glint {

/// A light and points that it shines on, for the conformance suite.
struct LightCase {
  std::string name;
  Lights lights;
  std::vector<Eigen::Vector3d> points_mm;  ///< each sees some of its front
};

inline std::vector<LightTriangle> tetrahedron_mm() {
  const Eigen::Vector3d a(0.0, 0.0, 20.0);
  const Eigen::Vector3d b(15.0, 0.0, -10.0);
  const Eigen::Vector3d c(-10.0, 12.0, -10.0);
  const Eigen::Vector3d d(-10.0, -12.0, -10.0);
  return {{a, b, c}, {a, c, d}, {a, d, b}, {b, d, c}};
}

inline Lights lights_of(const LightSettings& settings,
                        const RigidTransform& scene_from_camera = {}) {
  return build_lights({{.name = "light", .settings = settings}},
                      {.scene_from_camera = scene_from_camera},
                      [](const std::filesystem::path&) { return tetrahedron_mm(); });
}

/// A tunnel alone, to which directions are drawn; its positions take the stripes through one
/// period.
inline Lights lights_under(const TunnelSettings& settings, int positions = 4) {
  const double step_mm = settings.period_mm / std::cos(settings.orientation_rad) / positions;
  return build_lights({},
                      {},
                      {},
                      TunnelLight{.name = "tunnel",
                                  .settings = settings,
                                  .positions = positions,
                                  .step_mm = step_mm,
                                  .drawn_below = 2.0});
}

/// Intensity 10 (1 + cos) down to 0 straight up, more towards 0 degrees than towards 180.
inline IesTable some_table(bool to_both_sides) {
  IesTable table;
  table.file = "some.ies";
  for (int v = 0; v <= (to_both_sides ? 18 : 9); ++v) {
    table.vertical_rad.push_back(10.0 * v * kRadPerDeg);
  }
  for (int h = 0; h <= 12; ++h) {
    table.horizontal_rad.push_back(30.0 * h * kRadPerDeg);
    for (const double vertical : table.vertical_rad) {
      const double side = 1.0 + 0.5 * std::sin(vertical) * std::cos(table.horizontal_rad.back());
      table.intensity.push_back(10.0 * (1.0 + std::cos(vertical)) * side);
    }
  }
  return table;
}

/// A measured box at the origin of height 200, shining down.
inline Lights box_light(const Eigen::Vector3d& size_mm) {
  Lights lights;
  const EmitterFrame down = placed_frame({.position_mm = {0.0, 0.0, 200.0}}, {});
  lights.bodies.push_back({.table = some_table(true), .frame = down, .size_mm = size_mm});
  lights.groups.push_back({.name = "box"});
  lights.groups[0].power_w.setConstant(static_cast<float>(lights.bodies[0].table.flux()));
  const Eigen::Vector3d half = 0.5 * size_mm;
  const std::array<Eigen::Vector3d, 3> axes = {down.x, down.y, down.z};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector3d out = side * axes[i];
      const EmitterFrame frame = {.origin_mm = down.origin_mm + half[static_cast<int>(i)] * out,
                                  .x = axes[j],
                                  .y = side * axes[k],
                                  .z = out};
      lights.emitters.push_back({.shape = RectangleShape{.frame = frame,
                                                         .half_x_mm = half[static_cast<int>(j)],
                                                         .half_y_mm = half[static_cast<int>(k)]},
                                 .body = 0});
    }
  }
  lights.tree = LightTree(lights.emitters, lights.bodies);
  return lights;
}

/// Brighter to one side, a sun in one pixel, a black row at the bottom.
inline Lights sky_light() {
  Lights lights;
  std::vector<std::array<float, 3>> pixels;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 16; ++x) {
      const float level = y == 7 ? 0.0F : 1.0F + 0.2F * static_cast<float>(x % 9);
      const float sun = x == 5 && y == 2 ? 50.0F : 0.0F;
      pixels.push_back({level + sun, 0.5F * level + sun, 0.25F * level});
    }
  }
  lights.environment = Environment(16, 8, std::move(pixels));
  lights.environment_frame = frame_around({0.0, 0.0, 0.0}, Eigen::Vector3d(0.6, 0.0, 0.8));
  lights.environment_group = 0;
  lights.groups.push_back({.name = "sky"});
  return lights;
}

/// One of each kind. The points see the whole front of what they see of it at all.
inline std::vector<LightCase> every_light() {
  const std::vector<Eigen::Vector3d> below = {{0.0, 0.0, 0.0}, {30.0, -20.0, 10.0}};
  const RigidTransform scene_from_camera = {
      .rotation = Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()).toRotationMatrix(),
      .translation_mm = {5.0, 0.0, 150.0}};
  std::vector<LightCase> all;
  const auto add = [&](std::string name, const LightSettings& settings) {
    all.push_back({.name = std::move(name),
                   .lights = lights_of(settings, scene_from_camera),
                   .points_mm = below});
  };
  add("flat ring", RingSettings{.height_mm = 100.0});
  add("tilted ring in segments",
      RingSettings{.segments = {.segments = 5, .segment_power = {1.0, 2.0, 0.5, 1.0, 1.0}},
                   .height_mm = 100.0,
                   .tilt_rad = 0.5});
  add("LEDs on the camera",
      RingSettings{.placement = {.mount = LightPlacement::Mount::kCamera},
                   .emission = {.power_w = {1.0, 2.0, 3.0}, .half_angle_rad = 20.0 * kRadPerDeg},
                   .segments = {.segments = 4, .separate = true},
                   .height_mm = 16.0,
                   .tilt_rad = 0.3,
                   .leds = 24});
  add("hemisphere", DomeSettings{});
  add("deep dome", DomeSettings{.height_mm = 40.0, .opening_mm = 60.0, .rim_rad = 2.0});
  add("near bar",
      BarSettings{.placement = {.position_mm = {0.0, 40.0, 60.0}, .direction = {0.0, -1.0, -1.0}}});
  add("bar in segments",
      BarSettings{.emission = {.radiance = {3.0, 2.0, 1.0}, .half_angle_rad = 0.8},
                  .segments = {.segments = 7}});
  add("ring in many segments",
      RingSettings{.segments = {.segments = 16}, .height_mm = 60.0, .tilt_rad = -0.4});
  add("coaxial", CoaxialSettings{.placement = {.mount = LightPlacement::Mount::kCamera}});
  add("mesh",
      MeshLightSettings{
          .placement = {.position_mm = {0.0, 10.0, 70.0}, .direction = {0.0, 0.6, 0.8}},
          .file = "tetrahedron"});
  add("grey environment", EnvironmentSettings{});
  const auto add_tunnel = [&](std::string name, const TunnelSettings& settings) {
    all.push_back({.name = std::move(name), .lights = lights_under(settings), .points_mm = below});
  };
  add_tunnel("tunnel", {.shape = TunnelSettings::Shape::kEllipse, .length_mm = 250.0});
  add_tunnel("leaning panels with oblique stripes",
             {.shape = TunnelSettings::Shape::kFlat,
              .opening_rad = 0.5,
              .orientation_rad = 0.4,
              .cosine_law = true});
  all.push_back({.name = "sky", .lights = sky_light(), .points_mm = below});
  all.push_back(
      {.name = "measured box", .lights = box_light({60.0, 40.0, 20.0}), .points_mm = below});
  return all;
}

/// The integral of a function over the directions with z >= low_z by 2 n^2 midpoints.
inline double over_sphere(int n,
                          const std::function<double(const Eigen::Vector3d&)>& f,
                          double low_z = -1.0) {
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - (1.0 - low_z) * (i + 0.5) / n;
    const double r = std::sqrt(1.0 - z * z);
    for (int k = 0; k < 2 * n; ++k) {
      const double phi = kPi * (k + 0.5) / n;
      sum += f({r * std::cos(phi), r * std::sin(phi), z});
    }
  }
  return sum * 2.0 * kPi * (1.0 - low_z) / (2.0 * n * n);
}

/// Irradiance at a point by n^2 stratified samples.
inline Eigen::Array3d irradiance(const Lights& lights,
                                 const Eigen::Vector3d& point_mm,
                                 const Eigen::Vector3d& normal,
                                 int n) {
  Rng rng(7, Stream::kTest, 1);
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (int i = 0; i < n * n; ++i) {
    const int row = i / n;
    const double u = (i % n + rng.uniform()) / n;
    const double v = (row + rng.uniform()) / n;
    const auto s = sample_light(lights, point_mm, u, v);
    if (s && s->direction.dot(normal) > 0.0 && !is_occluded(lights, point_mm, *s)) {
      sum += s->radiance.cast<double>() * s->direction.dot(normal) / s->density;
    }
  }
  return sum / (n * n);
}

}  // namespace glint

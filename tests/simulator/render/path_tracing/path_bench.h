// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "simulator/camera/camera_settings.h"
#include "simulator/light/area/build_lights.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/path_tracing/render_paths.h"
#include "tests/simulator/render/path_tracing/path_images.h"

namespace glint::path_test {

inline constexpr std::array<double, 1> kGreen_nm = {550.0};

inline Lights lights_of(const std::vector<NamedLight>& lights,
                        const RigidTransform& scene_from_camera) {
  return build_lights(lights,
                      {.scene_from_camera = scene_from_camera},
                      [](const std::filesystem::path&) { return std::vector<LightTriangle>(); });
}

inline NamedLight white_sky(double radiance = 1.0) {
  EnvironmentSettings sky;
  sky.radiance = {radiance};
  return {.name = "sky", .settings = sky};
}

/// Everything a picture needs, owned.
struct PathBench {
  Part part;
  Bvh bvh;
  SurfaceDetail detail;
  SurfaceMaterial material;
  PinholeCamera camera;
  RigidTransform pose;
  Lights lights;
  std::vector<std::int32_t> labels;
  ThinLens lens;

  PathBench(Part built,
            const MaterialSettings& of_part,
            const std::vector<NamedLight>& named,
            const CameraSettings& camera_settings,
            const Viewpoint& from)
      : part(std::move(built)),
        bvh(part.mesh),
        material(of_part, kGreen_nm),
        camera(intrinsics_of(camera_settings)),
        pose(camera_from_world(from)),
        lights(lights_of(named, inverse(pose))) {}

  PathBench(const PartSettings& shape,
            const MaterialSettings& of_part,
            const std::vector<NamedLight>& named,
            const CameraSettings& camera_settings)
      : PathBench(build_part(shape),
                  of_part,
                  named,
                  camera_settings,
                  default_viewpoint(camera_settings)) {}

  PhysicalScene scene() const {
    return {.part = part,
            .bvh = bvh,
            .detail = detail,
            .material = material,
            .lights = lights,
            .camera = camera,
            .camera_from_world = pose,
            .lens = lens,
            .face_labels = labels};
  }

  Film render(const PathSettings& settings, int threads = 1) const {
    ThreadPool pool(threads);
    return render_paths(scene(), settings, pool);
  }

  ImageF picture(const PathSettings& settings, int threads = 1) const {
    return total_image(render(settings, threads), group_factors(lights), 0);
  }
};

inline CameraSettings small_camera(double object_pixel_mm = 1.0, int width = 16, int height = 16) {
  return {.width_px = width,
          .height_px = height,
          .object_pixel_mm = object_pixel_mm,
          .working_distance_mm = 300.0};
}

inline PartSettings flat_plate() {
  return {.shape = PartSettings::Shape::kPlate,
          .length_mm = 60.0,
          .width_mm = 40.0,
          .thickness_mm = 2.0};
}

inline PartSettings small_ball() {
  return {.shape = PartSettings::Shape::kSphereCap,
          .radius_mm = 10.0,
          .height_mm = 20.0,
          .facets_mm = 0.0};
}

inline MaterialSettings matt(double reflectance, double roughness = 0.0) {
  return {.type = MaterialSettings::Type::kDiffuse,
          .reflectance = {reflectance},
          .roughness = roughness};
}

/// Metal that reflects all light at every angle.
inline MaterialSettings white_metal(std::vector<double> alpha) {
  return {.type = MaterialSettings::Type::kConductor, .alpha = std::move(alpha), .schlick = false};
}

inline MaterialSettings white_mirror() {
  return {.type = MaterialSettings::Type::kMirror, .schlick = false};
}

inline NamedLight ring_at(double height_mm, std::string name = "ring") {
  RingSettings ring;
  ring.placement.position_mm = {0.0, 0.0, height_mm};
  return {.name = std::move(name), .settings = ring};
}

inline NamedLight bar_aside(std::string name = "bar") {
  BarSettings bar;
  bar.placement.position_mm = {0.0, 80.0, 100.0};
  bar.placement.direction = {0.0, -0.8, -1.0};
  return {.name = std::move(name), .settings = bar};
}

inline double mean_of(const ImageF& image) {
  double sum = 0.0;
  for (const float value : image.values()) {
    sum += static_cast<double>(value);
  }
  return sum / static_cast<double>(image.size());
}

inline double rms_difference(const ImageF& a, const ImageF& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = static_cast<double>(a.values()[i]) - static_cast<double>(b.values()[i]);
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace glint::path_test

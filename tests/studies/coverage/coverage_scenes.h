// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts whose coverage is known.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>

#include "core/thread_pool.h"
#include "core/units.h"
#include "simulator/geometry/mesh_file/mesh_write.h"
#include "studies/coverage/scene_coverage.h"

namespace glint {

inline Viewpoint viewpoint_at(const Eigen::Vector3d& position_mm) {
  const Eigen::Vector3d towards = -position_mm.normalized();
  const bool is_vertical = std::abs(towards.z()) > 0.9;
  return {.position_mm = {position_mm.x(), position_mm.y(), position_mm.z()},
          .direction = {towards.x(), towards.y(), towards.z()},
          .up = is_vertical ? std::vector{0.0, 1.0, 0.0} : std::vector{0.0, 0.0, 1.0}};
}

/// A camera whose picture is 120 x 120 mm at 300 mm, without light.
inline SceneSettings bare_scene() {
  SceneSettings scene;
  scene.has_tunnel = false;
  scene.camera.width_px = 1200;
  scene.camera.height_px = 1200;
  scene.camera.object_pixel_mm = 0.1;
  scene.camera.working_distance_mm = 300.0;
  scene.viewpoints = {viewpoint_at({0.0, 0.0, 300.0})};
  return scene;
}

/// A whole sphere of 25 mm radius around the origin.
inline SceneSettings sphere_scene() {
  SceneSettings scene = bare_scene();
  scene.part.shape = PartSettings::Shape::kSphereCap;
  scene.part.radius_mm = 25.0;
  scene.part.height_mm = 50.0;
  return scene;
}

inline SceneSettings gear_scene() {
  SceneSettings scene = bare_scene();
  scene.part.shape = PartSettings::Shape::kSpurGear;
  scene.part.gear = {.teeth = 20, .module_mm = 2.0, .face_width_mm = 15.0, .bore_mm = 16.0};
  scene.viewpoints = {viewpoint_at({300.0, 0.0, 0.0}),
                      viewpoint_at({0.0, 0.0, 300.0}),
                      viewpoint_at({100.0, 200.0, 200.0})};
  return scene;
}

inline constexpr double kCupRadius_mm = 20.0;  ///< inside
inline constexpr double kCupDepth_mm = 30.0;

/// A cup as a solid of revolution: floor of the inside at z = 0, rim at z = 30, wall and floor 2 mm
/// thick.
inline void write_cup(const std::filesystem::path& file) {
  constexpr int kSides = 512;
  constexpr double kWall_mm = 2.0;
  constexpr std::array<std::array<double, 2>, 4> kProfile = {
      {{kCupRadius_mm + kWall_mm, -kWall_mm},
       {kCupRadius_mm + kWall_mm, kCupDepth_mm},
       {kCupRadius_mm, kCupDepth_mm},
       {kCupRadius_mm, 0.0}}};
  TriangleMesh mesh;
  for (int side = 0; side < kSides; ++side) {
    const double angle_rad = 2.0 * kPi * side / kSides;
    for (const auto& [radius_mm, z_mm] : kProfile) {
      mesh.vertices_mm.emplace_back(
          radius_mm * std::cos(angle_rad), radius_mm * std::sin(angle_rad), z_mm);
    }
  }
  const int below = 4 * kSides;
  mesh.vertices_mm.emplace_back(0.0, 0.0, -kWall_mm);
  mesh.vertices_mm.emplace_back(0.0, 0.0, 0.0);
  for (int side = 0; side < kSides; ++side) {
    const int a = 4 * side;
    const int b = 4 * ((side + 1) % kSides);
    mesh.triangles.push_back({below, b, a});
    for (int k = 0; k < 3; ++k) {
      mesh.triangles.push_back({a + k, b + k, b + k + 1});
      mesh.triangles.push_back({a + k, b + k + 1, a + k + 1});
    }
    mesh.triangles.push_back({below + 1, a + 3, b + 3});
  }
  write_mesh(file, mesh);
}

inline SceneSettings cup_scene(const std::filesystem::path& file) {
  SceneSettings scene = bare_scene();
  scene.part.shape = PartSettings::Shape::kMesh;
  scene.part.file = file;
  scene.part.origin = PartSettings::Origin::kFile;
  return scene;
}

inline SceneCoverage cover(const SceneSettings& scene, int threads = 2) {
  ThreadPool pool(threads);
  SceneStore store(pool);
  return cover_scene(store, scene);
}

}  // namespace glint

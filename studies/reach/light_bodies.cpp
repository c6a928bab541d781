// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/reach/light_bodies.h"

#include <algorithm>
#include <utility>

#include "simulator/light/area/build_lights.h"
#include "studies/definition/scene_lights.h"
#include "studies/imaging/path_lights.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Straight pieces around a ring or a dome: they cut corners by 0.2 % of the radius.
constexpr int kPieces = 48;
constexpr int kRows = 8;

/// Adds a grid of points of the shape, whose surface is covered by u and v in [0, 1].
void add_grid(const EmitterShape& shape, int columns, int rows, TriangleMesh& mesh) {
  const auto first = static_cast<std::int32_t>(mesh.vertices_mm.size());
  for (int i = 0; i <= rows; ++i) {
    for (int k = 0; k <= columns; ++k) {
      const double u = static_cast<double>(i) / rows;
      const double v = static_cast<double>(k) / columns;
      mesh.vertices_mm.push_back(point_on(shape, u, v).point_mm);
    }
  }
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < columns; ++k) {
      const std::int32_t a = first + i * (columns + 1) + k;
      const std::int32_t b = a + columns + 1;
      mesh.triangles.push_back({a, a + 1, b});
      mesh.triangles.push_back({a + 1, b + 1, b});
    }
  }
}

void add_shape(const EmitterShape& shape, TriangleMesh& mesh) {
  if (const auto* triangle = std::get_if<TriangleShape>(&shape)) {
    const auto first = static_cast<std::int32_t>(mesh.vertices_mm.size());
    for (const Vector3d& corner : {triangle->a_mm, triangle->b_mm, triangle->c_mm}) {
      mesh.vertices_mm.push_back(corner);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  } else if (std::holds_alternative<RectangleShape>(shape)) {
    add_grid(shape, 1, 1, mesh);
  } else if (const auto* ring = std::get_if<RingShape>(&shape)) {
    const double share = ring->span_rad / (2.0 * kPi);
    add_grid(shape, std::max(2, static_cast<int>(share * kPieces)), 1, mesh);
  } else {
    add_grid(shape, kPieces, kRows, mesh);
  }
}

TriangleMesh mesh_of(const Lights& lights) {
  TriangleMesh mesh;
  for (const Emitter& emitter : lights.emitters) {
    if (emitter.is_solid) {
      add_shape(emitter.shape, mesh);
    }
  }
  weld(mesh);
  return mesh;
}

void add_body(std::string name,
              bool is_carried,
              TriangleMesh mesh,
              double thickness_mm,
              std::vector<SolidBody>& bodies) {
  if (mesh.triangles.empty()) {
    return;
  }
  constexpr int kFlange = 6;
  bodies.push_back({.name = std::move(name),
                    .kind = is_carried ? SolidBody::Kind::kCarried : SolidBody::Kind::kStanding,
                    .link = is_carried ? kFlange : 0,
                    .mesh = std::move(mesh),
                    .radius_mm = thickness_mm});
}

}  // namespace

std::vector<SolidBody> light_bodies(const SceneSettings& scene, double thickness_mm) {
  const auto vector = [](const std::vector<double>& v) { return Vector3d(v[0], v[1], v[2]); };
  const LightMounts mounts = {.scene_from_camera = {},
                              .scene_from_part = pose_from_angles(vector(scene.part.position_mm),
                                                                  vector(scene.part.rotation_rad))};
  const SceneSettings all = with_idle_lights(scene);
  std::vector<SolidBody> bodies;
  for (const NamedLight& light : all.lights) {
    if (has_place(light.settings)) {
      const bool is_carried = mount_of(light.settings) == LightPlacement::Mount::kCamera;
      add_body(light.name + " light",
               is_carried,
               mesh_of(build_lights({light}, mounts, load_light_mesh)),
               thickness_mm,
               bodies);
    }
  }
  SceneSettings alone = all;
  alone.lights.clear();
  add_body(scene.tunnel_name,
           false,
           mesh_of(unit_power_lights(alone, mounts, load_light_mesh).lights),
           thickness_mm,
           bodies);
  return bodies;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/rng.h"
#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/part/part.h"

namespace glint {

/// A cube from -half to +half, closed, faces outwards.
inline TriangleMesh cube_mesh(double half_mm) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_mm.emplace_back((i & 1) != 0 ? half_mm : -half_mm,
                                  (i & 2) != 0 ? half_mm : -half_mm,
                                  (i & 4) != 0 ? half_mm : -half_mm);
  }
  mesh.triangles = {{0, 2, 3},
                    {0, 3, 1},
                    {4, 5, 7},
                    {4, 7, 6},
                    {0, 1, 5},
                    {0, 5, 4},
                    {2, 6, 7},
                    {2, 7, 3},
                    {0, 4, 6},
                    {0, 6, 2},
                    {1, 3, 7},
                    {1, 7, 5}};
  return mesh;
}

/// A whole sphere as the parametric part makes it, around the origin.
inline Part sphere_part(double radius_mm) {
  PartSettings settings;
  settings.shape = PartSettings::Shape::kSphereCap;
  settings.radius_mm = radius_mm;
  settings.height_mm = 2.0 * radius_mm;
  return build_part(settings);
}

inline Eigen::Vector3d random_point(Rng& rng, double half_mm) {
  const double x = rng.uniform(-half_mm, half_mm);
  const double y = rng.uniform(-half_mm, half_mm);
  const double z = rng.uniform(-half_mm, half_mm);
  return {x, y, z};
}

inline Eigen::Vector3d random_direction(Rng& rng) {
  const double x = rng.normal();
  const double y = rng.normal();
  const double z = rng.normal();
  return Eigen::Vector3d(x, y, z).normalized();
}

inline RigidTransform random_pose(Rng& rng) {
  const Eigen::Vector3d axis = random_direction(rng);
  const double angle = rng.uniform(-3.0, 3.0);
  return {.rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix(),
          .translation_mm = random_point(rng, 50.0)};
}

}  // namespace glint

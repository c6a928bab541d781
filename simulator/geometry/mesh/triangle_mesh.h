// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"

namespace glint {

using Triangle = std::array<std::int32_t, 3>;

/// Axis-parallel box; empty while min > max.
struct BoundingBox {
  Eigen::Vector3d min_mm = Eigen::Vector3d::Constant(1e300);
  Eigen::Vector3d max_mm = Eigen::Vector3d::Constant(-1e300);

  bool is_empty() const { return (min_mm.array() > max_mm.array()).any(); }

  Eigen::Vector3d size_mm() const { return max_mm - min_mm; }

  Eigen::Vector3d centre_mm() const { return 0.5 * (min_mm + max_mm); }
};

/// A triangle mesh with shading normals per corner. Triangles turn counter-clockwise seen from
/// outside. Everything is in one frame: for Part::mesh the scene frame.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices_mm;
  std::vector<Triangle> triangles;  ///< indices into vertices_mm

  /// Unit shading normals, shared by the corners that are smoothed together.
  std::vector<Eigen::Vector3d> normals;
  /// Per triangle, indices into normals; as many as triangles, or empty before smooth_normals().
  std::vector<Triangle> corner_normals;

  /// Per triangle, the exact surface it stands for (index into Part::patches), -1 where the
  /// triangle itself is the surface; as many as triangles, or empty (all -1).
  std::vector<std::int32_t> patch;

  std::size_t num_triangles() const { return triangles.size(); }

  const Eigen::Vector3d& vertex(std::size_t triangle, std::size_t corner) const {
    return vertices_mm[static_cast<std::size_t>(triangles[triangle][corner])];
  }

  const Eigen::Vector3d& normal(std::size_t triangle, std::size_t corner) const {
    return normals[static_cast<std::size_t>(corner_normals[triangle][corner])];
  }

  std::int32_t patch_of(std::size_t triangle) const { return patch.empty() ? -1 : patch[triangle]; }
};

/// Unit normal of a triangle; zero for a triangle without area.
Eigen::Vector3d face_normal(const TriangleMesh& mesh, std::size_t triangle);

/// Half the cross product of two edges: along the normal, as long as the area [mm2].
Eigen::Vector3d area_vector(const TriangleMesh& mesh, std::size_t triangle);

double surface_area_mm2(const TriangleMesh& mesh);

/// The enclosed volume [mm3] by the divergence theorem; meaningful for a closed mesh only.
double enclosed_volume_mm3(const TriangleMesh& mesh);

BoundingBox bounding_box(const TriangleMesh& mesh);

/// Shading normals: at each vertex the mean of the face normals weighted by the corner's angle,
/// over the faces that can be reached without crossing an edge whose faces meet at more than
/// crease_rad. Open, non-manifold and inconsistently turned edges count as creases.
///
/// Source: G. Thuermer and C. Wuethrich, "Computing vertex normals from polygonal facets",
/// Journal of Graphics Tools 3(1), 1998.
void smooth_normals(TriangleMesh& mesh, double crease_rad);

/// Merges vertices of equal coordinates (bit for bit, -0 = +0), drops triangles that become a line
/// or a point and vertices no triangle uses; keeps the order of what is left. Shading normals and
/// patches are kept. Returns how many triangles were dropped.
std::size_t weld(TriangleMesh& mesh);

/// Moves vertices and normals.
void transform(TriangleMesh& mesh, const RigidTransform& target_from_source);

/// Angle [rad] between two face normals, in [0, pi]; 0 when one of them has no area.
double angle_between_faces(const TriangleMesh& mesh, std::size_t a, std::size_t b);

/// First fault that makes a mesh unusable, as a sentence ("vertex 17 is not finite"); empty when
/// there is none. Faults: no triangle, an index out of range, a coordinate that is not finite.
std::string find_fault(const TriangleMesh& mesh);

}  // namespace glint

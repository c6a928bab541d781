// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/bvh/triangle_planes.h"

#include <algorithm>
#include <cstddef>

#include "core/index.h"
#include "simulator/geometry/mesh/mesh_edges.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Rounding of coordinates; far below what a reflected ray is lifted by.
constexpr double kFlat_mm = 1e-7;

/// True when no vertex lies in front of some of the triangles: quick to tell a part that is not
/// convex.
bool may_be_convex(const TriangleMesh& mesh, const std::vector<TrianglePlane>& planes) {
  constexpr std::size_t kProbes = 16;
  const std::size_t stride = 1 + planes.size() / kProbes;
  for (std::size_t i = 0; i < planes.size(); i += stride) {
    const Vector3d normal(planes[i].normal_x, planes[i].normal_y, planes[i].normal_z);
    const auto is_in_front = [&](const Vector3d& p) {
      return normal.dot(p) > planes[i].offset_mm + kFlat_mm;
    };
    if (std::ranges::any_of(mesh.vertices_mm, is_in_front)) {
      return false;
    }
  }
  return !planes.empty();
}

/// The corner of a triangle that is not on an edge.
const Vector3d& opposite(const TriangleMesh& mesh, std::int32_t triangle, const MeshEdge& edge) {
  const auto is_off = [&](std::int32_t v) { return v != edge.from && v != edge.to; };
  const Triangle& corners = mesh.triangles[index(triangle)];
  return mesh.vertices_mm[index(*std::ranges::find_if(corners, is_off))];
}

}  // namespace

std::vector<TrianglePlane> planes_of(const TriangleMesh& mesh) {
  std::vector<TrianglePlane> planes;
  planes.reserve(mesh.num_triangles());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Vector3d normal = face_normal(mesh, i);
    planes.push_back({.normal_x = normal.x(),
                      .normal_y = normal.y(),
                      .normal_z = normal.z(),
                      .offset_mm = normal.dot(mesh.vertex(i, 0))});
  }
  return planes;
}

bool is_closed_convex(const TriangleMesh& mesh, const std::vector<TrianglePlane>& planes) {
  if (!may_be_convex(mesh, planes)) {
    return false;
  }
  const std::vector<MeshEdge> edges = mesh_edges(mesh);
  if (mesh.vertices_mm.size() + mesh.num_triangles() != edges.size() + 2) {
    return false;
  }
  return std::ranges::all_of(edges, [&](const MeshEdge& edge) {
    if (edge.num_faces != 2 || !edge.is_consistent) {
      return false;
    }
    const TrianglePlane& plane = planes[index(edge.triangle_a)];
    const Vector3d& p = opposite(mesh, edge.triangle_b, edge);
    return plane.normal_x * p.x() + plane.normal_y * p.y() + plane.normal_z * p.z() <=
           plane.offset_mm + kFlat_mm;
  });
}

std::vector<std::uint8_t> find_flat_triangles(const TriangleMesh& mesh,
                                              const std::vector<TrianglePlane>& planes) {
  constexpr double kSame = 1e-7;  // rounding of normals to float, which is what looks them up
  std::vector<std::uint8_t> flat(planes.size(), 1);
  for (std::size_t i = 0; i < planes.size() && !mesh.corner_normals.empty(); ++i) {
    const Vector3d face(planes[i].normal_x, planes[i].normal_y, planes[i].normal_z);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const bool is_same = (mesh.normal(i, corner) - face).cwiseAbs().maxCoeff() <= kSame;
      flat[i] = is_same ? flat[i] : std::uint8_t{0};
    }
  }
  return flat;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/disjoint_sets.h"
#include "core/index.h"
#include "simulator/geometry/mesh/mesh_edges.h"

namespace glint {
namespace {

using Eigen::Vector3d;

int corner_at(const Triangle& triangle, std::int32_t vertex) {
  return triangle[0] == vertex ? 0 : (triangle[1] == vertex ? 1 : 2);
}

/// Joins the corners of two triangles at both ends of the edge they share.
void join_across(const TriangleMesh& mesh, const MeshEdge& edge, DisjointSets& corners) {
  for (const std::int32_t vertex : {edge.from, edge.to}) {
    corners.join(3 * edge.triangle_a + corner_at(mesh.triangles[index(edge.triangle_a)], vertex),
                 3 * edge.triangle_b + corner_at(mesh.triangles[index(edge.triangle_b)], vertex));
  }
}

double corner_angle(const TriangleMesh& mesh, std::size_t triangle, std::size_t corner) {
  const Vector3d& p = mesh.vertex(triangle, corner);
  const Vector3d a = mesh.vertex(triangle, (corner + 1) % 3) - p;
  const Vector3d b = mesh.vertex(triangle, (corner + 2) % 3) - p;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Turns sums into unit normals; a set of faces without area gets +z.
void normalise(std::vector<Vector3d>& normals) {
  for (Vector3d& normal : normals) {
    const double length = normal.norm();
    normal = length > 0.0 ? Vector3d(normal / length) : Vector3d::UnitZ();
  }
}

bool comes_before(const Vector3d& a, const Vector3d& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// For each vertex, the first vertex of equal coordinates.
std::vector<std::int32_t> first_equals(const std::vector<Vector3d>& vertices_mm) {
  std::vector<std::int32_t> order(vertices_mm.size());
  std::iota(order.begin(), order.end(), std::int32_t{0});
  std::ranges::sort(order, [&](std::int32_t a, std::int32_t b) {
    const Vector3d& p = vertices_mm[index(a)];
    const Vector3d& q = vertices_mm[index(b)];
    return p == q ? a < b : comes_before(p, q);
  });
  std::vector<std::int32_t> first(vertices_mm.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_equal = i > 0 && vertices_mm[index(order[i])] == vertices_mm[index(order[i - 1])];
    first[index(order[i])] = is_equal ? first[index(order[i - 1])] : order[i];
  }
  return first;
}

/// Drops vertices no triangle uses, keeping the order of the others.
void drop_unused_vertices(TriangleMesh& mesh) {
  std::vector<std::int32_t> new_index(mesh.vertices_mm.size(), -1);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::int32_t vertex : triangle) {
      new_index[index(vertex)] = 0;
    }
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < new_index.size(); ++i) {
    if (new_index[i] == 0) {
      mesh.vertices_mm[count] = mesh.vertices_mm[i];
      new_index[i] = static_cast<std::int32_t>(count++);
    }
  }
  mesh.vertices_mm.resize(count);
  for (Triangle& triangle : mesh.triangles) {
    for (std::int32_t& vertex : triangle) {
      vertex = new_index[index(vertex)];
    }
  }
}

}  // namespace

Vector3d area_vector(const TriangleMesh& mesh, std::size_t triangle) {
  const Vector3d& p = mesh.vertex(triangle, 0);
  return 0.5 * (mesh.vertex(triangle, 1) - p).cross(mesh.vertex(triangle, 2) - p);
}

Vector3d face_normal(const TriangleMesh& mesh, std::size_t triangle) {
  const Vector3d vector = area_vector(mesh, triangle);
  const double length = vector.norm();
  return length > 0.0 ? Vector3d(vector / length) : Vector3d::Zero();
}

double surface_area_mm2(const TriangleMesh& mesh) {
  double area_mm2 = 0.0;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    area_mm2 += area_vector(mesh, i).norm();
  }
  return area_mm2;
}

double enclosed_volume_mm3(const TriangleMesh& mesh) {
  const BoundingBox box = bounding_box(mesh);
  if (box.is_empty()) {
    return 0.0;
  }
  double six_volumes = 0.0;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    // From the box's centre: less cancellation for a part far from the origin.
    six_volumes += 2.0 * area_vector(mesh, i).dot(mesh.vertex(i, 0) - box.centre_mm());
  }
  return six_volumes / 6.0;
}

BoundingBox bounding_box(const TriangleMesh& mesh) {
  BoundingBox box;
  for (const Vector3d& vertex : mesh.vertices_mm) {
    box.min_mm = box.min_mm.cwiseMin(vertex);
    box.max_mm = box.max_mm.cwiseMax(vertex);
  }
  return box;
}

double angle_between_faces(const TriangleMesh& mesh, std::size_t a, std::size_t b) {
  const Vector3d n = area_vector(mesh, a);
  const Vector3d m = area_vector(mesh, b);
  if (n.isZero(0.0) || m.isZero(0.0)) {
    return 0.0;
  }
  return std::atan2(n.cross(m).norm(), n.dot(m));
}

void smooth_normals(TriangleMesh& mesh, double crease_rad) {
  const std::size_t num_corners = 3 * mesh.num_triangles();
  DisjointSets corners(num_corners);
  for (const MeshEdge& edge : mesh_edges(mesh)) {
    if (edge.is_consistent &&
        angle_between_faces(mesh, index(edge.triangle_a), index(edge.triangle_b)) <= crease_rad) {
      join_across(mesh, edge, corners);
    }
  }
  std::vector<std::int32_t> normal_of(num_corners, -1);
  mesh.normals.clear();
  mesh.corner_normals.assign(mesh.num_triangles(), {});
  for (std::size_t i = 0; i < num_corners; ++i) {
    std::int32_t& normal = normal_of[index(corners.find(static_cast<std::int32_t>(i)))];
    if (normal < 0) {
      normal = static_cast<std::int32_t>(mesh.normals.size());
      mesh.normals.emplace_back(Vector3d::Zero());
    }
    mesh.normals[index(normal)] += corner_angle(mesh, i / 3, i % 3) * face_normal(mesh, i / 3);
    mesh.corner_normals[i / 3][i % 3] = normal;
  }
  normalise(mesh.normals);
}

std::size_t weld(TriangleMesh& mesh) {
  for (Vector3d& vertex : mesh.vertices_mm) {
    vertex.array() += 0.0;  // -0 becomes +0
  }
  const std::vector<std::int32_t> first = first_equals(mesh.vertices_mm);
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    Triangle triangle = mesh.triangles[i];
    for (std::int32_t& vertex : triangle) {
      vertex = first[index(vertex)];
    }
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
      continue;
    }
    mesh.triangles[count] = triangle;
    if (!mesh.corner_normals.empty()) {
      mesh.corner_normals[count] = mesh.corner_normals[i];
    }
    if (!mesh.patch.empty()) {
      mesh.patch[count] = mesh.patch[i];
    }
    ++count;
  }
  const std::size_t dropped = mesh.num_triangles() - count;
  mesh.triangles.resize(count);
  mesh.corner_normals.resize(mesh.corner_normals.empty() ? 0 : count);
  mesh.patch.resize(mesh.patch.empty() ? 0 : count);
  drop_unused_vertices(mesh);
  return dropped;
}

void transform(TriangleMesh& mesh, const RigidTransform& target_from_source) {
  for (Vector3d& vertex : mesh.vertices_mm) {
    vertex = target_from_source * vertex;
  }
  for (Vector3d& normal : mesh.normals) {
    normal = target_from_source.rotation * normal;
  }
}

std::string find_fault(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) {
    return "it holds no triangle";
  }
  for (std::size_t i = 0; i < mesh.vertices_mm.size(); ++i) {
    if (!mesh.vertices_mm[i].allFinite()) {
      return fmt::format("vertex {} is not finite", i);
    }
  }
  const auto num_vertices = static_cast<std::int64_t>(mesh.vertices_mm.size());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    for (const std::int32_t vertex : mesh.triangles[i]) {
      if (vertex < 0 || vertex >= num_vertices) {
        return fmt::format(
            "face {} names vertex {}, but there are only {}", i, vertex, num_vertices);
      }
    }
  }
  return "";
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/whole_mesh_boolean.h"

#include <chrono>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

namespace glint {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

Mesh mesh_of(const TriangleMesh& plain) {
  Mesh mesh;
  for (const Eigen::Vector3d& point : plain.vertices_mm) {
    mesh.add_vertex({point.x(), point.y(), point.z()});
  }
  auto vertex = [](std::int32_t i) { return Mesh::Vertex_index(static_cast<Mesh::size_type>(i)); };
  for (const Triangle& t : plain.triangles) {
    mesh.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2]));
  }
  return mesh;
}

}  // namespace

double whole_mesh_difference_seconds(const TriangleMesh& part,
                                     const std::vector<TriangleMesh>& tools) {
  Mesh mesh = mesh_of(part);
  double seconds = 0.0;
  for (const TriangleMesh& tool : tools) {
    Mesh cutter = mesh_of(tool);
    const auto start = std::chrono::steady_clock::now();
    CGAL::Polygon_mesh_processing::corefine_and_compute_difference(mesh, cutter, mesh);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return seconds;
}

}  // namespace glint

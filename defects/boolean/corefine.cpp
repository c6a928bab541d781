// SPDX-License-Identifier: GPL-3.0-or-later
//
// Splits two surfaces along their intersection by CGAL (Polygon Mesh Processing, corefine()), and
// wraps its exact predicates; no other file includes CGAL. A visitor keeps for each new face the
// face it is a piece of. Used where corefine_general.h declines: corners or edges of one surface
// that lie on the other. docs/theory/imprint.md, "Boolean operation". Cost: several times that of
// corefine_general.h, as intersections are constructed exactly.
//
// CGAL's own checks stay on in every build: what it refuses becomes a declined imprint.
#define CGAL_DEBUG 1

#include "defects/boolean/corefine.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/intersections.h>

namespace glint {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Vertex = Mesh::Vertex_index;
using Face = Mesh::Face_index;
using Halfedge = Mesh::Halfedge_index;
using SeamMap = Mesh::Property_map<Mesh::Edge_index, bool>;

Point point_of(const Eigen::Vector3d& point) {
  return {point.x(), point.y(), point.z()};
}

/// Exceptions are all we want of a failure, not a text on the terminal too.
void be_quiet(const char*, const char*, const char*, int, const char*) {}

void set_up_error_handling() {
  static const bool is_set = [] {
    CGAL::set_error_handler(be_quiet);
    CGAL::set_warning_handler(be_quiet);
    return true;
  }();
  static_cast<void>(is_set);
}

/// Follows faces while they are split.
struct ParentVisitor : CGAL::Polygon_mesh_processing::Corefinement::Default_visitor<Mesh> {
  const Mesh* first = nullptr;
  std::array<std::vector<std::int32_t>*, 2> parents = {};
  std::int32_t current = -1;

  std::vector<std::int32_t>& parents_of(const Mesh& mesh) const {
    return *parents[&mesh == first ? 0 : 1];
  }

  void before_subface_creations(Face face, const Mesh& mesh) { current = parents_of(mesh)[face]; }

  void after_subface_created(Face face, const Mesh& mesh) {
    std::vector<std::int32_t>& parent = parents_of(mesh);
    if (parent.size() <= face) {
      parent.resize(std::size_t{face} + 1, -1);
    }
    parent[face] = current;
  }
};

/// False when the faces do not make a surface.
bool fill(Mesh& mesh, const PlainMesh& plain) {
  mesh.reserve(static_cast<Mesh::size_type>(2 * plain.points_mm.size()),
               static_cast<Mesh::size_type>(4 * plain.faces.size()),
               static_cast<Mesh::size_type>(3 * plain.faces.size()));
  for (const Eigen::Vector3d& point : plain.points_mm) {
    mesh.add_vertex(point_of(point));
  }
  auto vertex = [](std::int32_t index) { return Vertex(static_cast<Mesh::size_type>(index)); };
  for (const Triangle& face : plain.faces) {
    const Face added = mesh.add_face(vertex(face[0]), vertex(face[1]), vertex(face[2]));
    if (added == Mesh::null_face()) {
      return false;
    }
  }
  return true;
}

std::vector<std::int32_t> own_parents(const PlainMesh& plain) {
  std::vector<std::int32_t> parents(plain.faces.size());
  for (std::size_t i = 0; i < parents.size(); ++i) {
    parents[i] = static_cast<std::int32_t>(i);
  }
  return parents;
}

/// The corner in which a halfedge starts; halfedges(face) of a corner's face start with mesh's own.
std::int32_t corner_of(const Mesh& mesh, Halfedge edge, const std::vector<std::int32_t>& place) {
  const Face face = mesh.face(edge);
  const Halfedge first = mesh.halfedge(face);
  const std::int32_t k = edge == first ? 0 : edge == mesh.next(first) ? 1 : 2;
  return 3 * place[face] + k;
}

/// Of each face among those that are left.
std::vector<std::int32_t> places_of_faces(const Mesh& mesh) {
  std::vector<std::int32_t> place(mesh.num_faces(), -1);
  std::int32_t num_faces = 0;
  for (const Face face : mesh.faces()) {
    place[face] = num_faces++;
  }
  return place;
}

CorefinedMesh read_back(const Mesh& mesh,
                        const SeamMap& is_seam,
                        const std::vector<std::int32_t>& parents) {
  CorefinedMesh out;
  out.points_mm.reserve(mesh.num_vertices());
  for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
    const Point& point = mesh.point(Vertex(static_cast<Mesh::size_type>(i)));
    out.points_mm.emplace_back(point.x(), point.y(), point.z());
  }
  const std::vector<std::int32_t> place = places_of_faces(mesh);
  for (const Face face : mesh.faces()) {
    Halfedge edge = mesh.halfedge(face);
    Triangle corners = {};
    for (std::int32_t& corner : corners) {
      corner = static_cast<std::int32_t>(mesh.source(edge));
      const Halfedge other = mesh.opposite(edge);
      out.opposite.push_back(mesh.is_border(other) ? -1 : corner_of(mesh, other, place));
      out.is_seam.push_back(is_seam[mesh.edge(edge)] ? 1 : 0);
      edge = mesh.next(edge);
    }
    out.faces.push_back(corners);
    out.parent.push_back(parents[face]);
  }
  return out;
}

CorefinedPair corefine_or_throw(const PlainMesh& first, const PlainMesh& second) {
  namespace parameters = CGAL::parameters;
  // One array, so that the meshes' addresses, which order CGAL's tables, have the same order
  // always.
  std::array<Mesh, 2> meshes;
  if (!fill(meshes[0], first) || !fill(meshes[1], second)) {
    return {};
  }
  std::array<std::vector<std::int32_t>, 2> parents = {own_parents(first), own_parents(second)};
  ParentVisitor visitor;
  visitor.first = &meshes[0];
  visitor.parents = {&parents[0], &parents[1]};
  const SeamMap seam_a = meshes[0].add_property_map<Mesh::Edge_index, bool>("e:seam", false).first;
  const SeamMap seam_b = meshes[1].add_property_map<Mesh::Edge_index, bool>("e:seam", false).first;
  CGAL::Polygon_mesh_processing::corefine(
      meshes[0],
      meshes[1],
      parameters::visitor(visitor).edge_is_constrained_map(seam_a),
      parameters::edge_is_constrained_map(seam_b));
  return {.is_done = true,
          .first = read_back(meshes[0], seam_a, parents[0]),
          .second = read_back(meshes[1], seam_b, parents[1])};
}

Kernel::Triangle_3 triangle_of(const Corners& c) {
  return {point_of(c[0]), point_of(c[1]), point_of(c[2])};
}

Kernel::Segment_3 far_edge_of(const Corners& c) {
  return {point_of(c[1]), point_of(c[2])};
}

}  // namespace

CorefinedPair corefine(const PlainMesh& first, const PlainMesh& second) {
  set_up_error_handling();
  try {
    return corefine_or_throw(first, second);
  } catch (const std::exception&) {
    return {};  // CGAL's word for surfaces it cannot work on, and nothing else throws here
  }
}

int exact_orientation(const Eigen::Vector3d& a,
                      const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d) {
  return static_cast<int>(CGAL::orientation(point_of(a), point_of(b), point_of(c), point_of(d)));
}

bool are_collinear(const Corners& c) {
  return CGAL::collinear(point_of(c[0]), point_of(c[1]), point_of(c[2]));
}

bool triangles_intersect(const Corners& a, const Corners& b) {
  return CGAL::do_intersect(triangle_of(a), triangle_of(b));
}

bool triangles_cross_at_corner(const Corners& a, const Corners& b) {
  return CGAL::do_intersect(triangle_of(a), far_edge_of(b)) ||
         CGAL::do_intersect(triangle_of(b), far_edge_of(a));
}

bool triangles_cross_at_edge(const Corners& a, const Corners& b) {
  const Point from = point_of(a[0]);
  const Point to = point_of(a[1]);
  const Point apex_a = point_of(a[2]);
  const Point apex_b = point_of(b[2]);
  return CGAL::coplanar(from, to, apex_a, apex_b) &&
         CGAL::coplanar_orientation(from, to, apex_a, apex_b) == CGAL::POSITIVE;
}

}  // namespace glint

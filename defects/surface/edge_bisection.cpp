// SPDX-License-Identifier: GPL-3.0-or-later
//
// Local refinement of a mesh by bisecting longest edges. Before a face is bisected, the path of
// neighbours with ever longer edges is followed to its end, where two faces share their longest
// edge, and refined from there (M.-C. Rivara 1997): closed meshes stay closed, and no angle falls
// below half the smallest one. Lengths are compared with ties broken by vertex numbers, so that two
// faces never disagree. docs/theory/imprint.md, "Displacement". Cost: one pass over the mesh to
// index it, then constant per bisection.
#include "defects/surface/edge_bisection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <Eigen/Geometry>

#include "core/error.h"
#include "defects/surface/surface_normals.h"

namespace glint {
namespace {

using Eigen::Vector3d;

std::uint64_t key_of(std::int32_t from, std::int32_t to) {
  return (static_cast<std::uint64_t>(from) << 32) | static_cast<std::uint64_t>(to);
}

std::size_t corner_of(const Triangle& triangle, std::int32_t vertex) {
  return triangle[0] == vertex ? 0 : (triangle[1] == vertex ? 1 : 2);
}

bool has_vertex(const Triangle& triangle, std::int32_t vertex) {
  return std::ranges::find(triangle, vertex) != triangle.end();
}

}  // namespace

Vector3d edge_point(std::span<const ExactPatch> patches,
                    std::span<const std::int32_t> patch_ids,
                    const Vector3d& a_mm,
                    const Vector3d& b_mm) {
  Vector3d middle = 0.5 * (a_mm + b_mm);
  std::array<std::int32_t, 3> distinct = {};
  std::size_t count = 0;
  for (const std::int32_t id : patch_ids) {
    const auto end = distinct.begin() + static_cast<std::ptrdiff_t>(count);
    if (id < 0 || (std::find(distinct.begin(), end, id) == end && count == distinct.size())) {
      return middle;
    }
    if (std::find(distinct.begin(), end, id) == end) {
      distinct[count++] = id;
    }
  }
  constexpr double kMaxMoveShare = 0.25;
  return onto_patches(
      patches, std::span(distinct).first(count), middle, kMaxMoveShare * (b_mm - a_mm).norm());
}

Vector3d edge_normal(std::span<const ExactPatch> patches,
                     std::int32_t patch,
                     const Vector3d& point_mm,
                     const Vector3d& normal_a,
                     const Vector3d& normal_b) {
  if (patch >= 0) {
    if (const auto normal = exact_normal(patches[at(patch)], point_mm)) {
      return *normal;
    }
  }
  const Vector3d sum = normal_a + normal_b;
  return sum.norm() > 1e-6 ? Vector3d(sum.normalized()) : normal_a;
}

EdgeBisection::EdgeBisection(TriangleMesh& mesh,
                             std::vector<std::int32_t>& labels,
                             std::vector<std::int32_t>& origin,
                             std::span<const ExactPatch> patches)
    : mesh_(mesh),
      labels_(labels),
      origin_(origin),
      patches_(patches),
      corners_(mesh),
      num_old_vertices_(mesh.vertices_mm.size()) {
  GLINT_CHECK(mesh.corner_normals.empty() || mesh.corner_normals.size() == mesh.num_triangles(),
              "normals for every face or for none");
  GLINT_CHECK(labels.size() == mesh.num_triangles() && origin.size() == mesh.num_triangles(),
              "one label and one origin a face");
}

bool EdgeBisection::Edge::is_shorter_than(const Edge& other) const {
  return std::tie(squared_mm2, from, to) < std::tie(other.squared_mm2, other.from, other.to);
}

EdgeBisection::Edge EdgeBisection::edge_of(std::int32_t face, std::size_t corner) const {
  const Triangle& triangle = mesh_.triangles[at(face)];
  const auto [low, high] = std::minmax(triangle[corner], triangle[(corner + 1) % 3]);
  return {.from = low,
          .to = high,
          .squared_mm2 = (mesh_.vertices_mm[at(high)] - mesh_.vertices_mm[at(low)]).squaredNorm()};
}

EdgeBisection::Edge EdgeBisection::longest_edge(std::int32_t face) const {
  Edge longest = edge_of(face, 0);
  for (std::size_t k = 1; k < 3; ++k) {
    const Edge edge = edge_of(face, k);
    if (longest.is_shorter_than(edge)) {
      longest = edge;
    }
  }
  return longest;
}

/// An edge is looked up before any face at it is cut, so that the old corners still tell.
std::vector<std::int32_t>& EdgeBisection::faces_at(const Edge& edge) {
  const auto [place, is_new] = edge_faces_.try_emplace(key_of(edge.from, edge.to));
  if (is_new && at(edge.from) < num_old_vertices_) {
    for (const std::int32_t corner : corners_.of(edge.from)) {
      if (has_vertex(mesh_.triangles[at(corner / 3)], edge.to)) {
        place->second.push_back(corner / 3);
      }
    }
  }
  return place->second;
}

/// Follows neighbours whose longest edge is longer until the faces at an edge agree.
EdgeBisection::Edge EdgeBisection::end_of_path(std::int32_t face) {
  Edge edge = longest_edge(face);
  for (;;) {
    bool is_end = true;
    for (const std::int32_t neighbour : faces_at(edge)) {
      const Edge longer = longest_edge(neighbour);
      if (!(longer == edge)) {
        edge = longer;
        is_end = false;
        break;
      }
    }
    if (is_end) {
      return edge;
    }
  }
}

std::vector<std::int32_t> EdgeBisection::refine(std::vector<std::int32_t> faces,
                                                const AllowedEdge& allowed) {
  touched_ = faces;
  while (!faces.empty()) {
    const std::int32_t face = faces.back();
    const double allowed_mm = allowed(face);
    if (longest_edge(face).squared_mm2 <= allowed_mm * allowed_mm) {
      faces.pop_back();
      continue;
    }
    const std::size_t before = touched_.size();
    bisect(end_of_path(face));
    faces.insert(
        faces.end(), touched_.begin() + static_cast<std::ptrdiff_t>(before), touched_.end());
  }
  std::ranges::sort(touched_);
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  return std::move(touched_);
}

std::vector<std::int32_t> EdgeBisection::old_faces_at(std::int32_t vertex) const {
  std::vector<std::int32_t> faces;
  if (at(vertex) < num_old_vertices_) {
    for (const std::int32_t corner : corners_.of(vertex)) {
      if (has_vertex(mesh_.triangles[at(corner / 3)], vertex)) {
        faces.push_back(corner / 3);
      }
    }
  }
  return faces;
}

void EdgeBisection::bisect(const Edge& edge) {
  const std::vector<std::int32_t> faces = faces_at(edge);
  for (const std::int32_t face : faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      faces_at(edge_of(face, k));
    }
  }
  const std::int32_t vertex = add_vertex(edge, faces);
  new_normals_.clear();
  for (const std::int32_t face : faces) {
    const int normal =
        has_normals() ? normal_for(face, edge, mesh_.vertices_mm[at(vertex)]) : kNoNormal;
    touched_.push_back(face);
    touched_.push_back(split_face(face, edge, vertex, normal));
  }
  edge_faces_.erase(key_of(edge.from, edge.to));
}

std::int32_t EdgeBisection::add_vertex(const Edge& edge, const std::vector<std::int32_t>& faces) {
  const Vector3d a = mesh_.vertices_mm[at(edge.from)];
  const Vector3d b = mesh_.vertices_mm[at(edge.to)];
  std::vector<std::int32_t> patch_ids;
  for (const std::int32_t face : faces) {
    patch_ids.push_back(mesh_.patch_of(at(face)));
  }
  Vector3d p = edge_point(patches_, patch_ids, a, b);
  if (!keeps_faces(edge, faces, p)) {
    p = 0.5 * (a + b);
  }
  mesh_.vertices_mm.push_back(p);
  return static_cast<std::int32_t>(mesh_.vertices_mm.size() - 1);
}

/// False when a point off the edge would turn one of the halves over.
bool EdgeBisection::keeps_faces(const Edge& edge,
                                const std::vector<std::int32_t>& faces,
                                const Vector3d& p_mm) const {
  return std::ranges::all_of(faces, [&](std::int32_t face) {
    const Vector3d whole = area_vector(mesh_, at(face));
    return std::ranges::all_of(std::array<std::int32_t, 2>{edge.from, edge.to}, [&](auto end) {
      std::array<Vector3d, 3> q = {};
      for (std::size_t k = 0; k < 3; ++k) {
        q[k] = mesh_.vertex(at(face), k);
      }
      q[corner_of(mesh_.triangles[at(face)], end)] = p_mm;
      constexpr double kMinShare = 0.1;
      return 0.5 * (q[1] - q[0]).cross(q[2] - q[0]).dot(whole) > kMinShare * whole.squaredNorm();
    });
  });
}

/// Faces that share the normals of both ends share the new one.
int EdgeBisection::normal_for(std::int32_t face, const Edge& edge, const Vector3d& p_mm) {
  const Triangle& triangle = mesh_.triangles[at(face)];
  const Triangle& corner_normals = mesh_.corner_normals[at(face)];
  const std::int32_t low = corner_normals[corner_of(triangle, edge.from)];
  const std::int32_t high = corner_normals[corner_of(triangle, edge.to)];
  for (const NewNormal& known : new_normals_) {
    if (known.low == low && known.high == high) {
      return known.index;
    }
  }
  const Vector3d normal = edge_normal(
      patches_, mesh_.patch_of(at(face)), p_mm, mesh_.normals[at(low)], mesh_.normals[at(high)]);
  mesh_.normals.push_back(normal);
  new_normals_.push_back(
      {.low = low, .high = high, .index = static_cast<int>(mesh_.normals.size() - 1)});
  return new_normals_.back().index;
}

/// The face keeps the half at the edge's first end; returns the face of the other half.
std::int32_t EdgeBisection::split_face(std::int32_t face,
                                       const Edge& edge,
                                       std::int32_t vertex,
                                       int normal) {
  const auto other = static_cast<std::int32_t>(mesh_.num_triangles());
  const Triangle triangle = mesh_.triangles[at(face)];
  const std::size_t from = corner_of(triangle, edge.from);
  const std::size_t to = corner_of(triangle, edge.to);
  const std::int32_t opposite = triangle[3 - from - to];
  mesh_.triangles.push_back(triangle);
  mesh_.triangles[at(face)][to] = vertex;
  mesh_.triangles[at(other)][from] = vertex;
  if (has_normals()) {
    const Triangle normals = mesh_.corner_normals[at(face)];
    mesh_.corner_normals.push_back(normals);
    mesh_.corner_normals[at(face)][to] = normal;
    mesh_.corner_normals[at(other)][from] = normal;
  }
  labels_.push_back(std::int32_t{labels_[at(face)]});
  origin_.push_back(std::int32_t{origin_[at(face)]});
  if (!mesh_.patch.empty()) {
    mesh_.patch.push_back(std::int32_t{mesh_.patch[at(face)]});
  }
  // The new vertex has the highest number of all.
  edge_faces_[key_of(edge.from, vertex)].push_back(face);
  edge_faces_[key_of(edge.to, vertex)].push_back(other);
  edge_faces_[key_of(opposite, vertex)] = {face, other};
  const auto [low, high] = std::minmax(edge.to, opposite);
  std::ranges::replace(edge_faces_[key_of(low, high)], face, other);
  return other;
}

}  // namespace glint

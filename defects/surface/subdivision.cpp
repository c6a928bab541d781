// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cuts every triangle into four. Midpoint subdivision keeps the shape, with new vertices of exact
// faces on their exact surface; Loop's rule (C. Loop 1987, with the creases of Hoppe et al. 1994)
// gives the places that make free faces a smooth surface. Faces 4 i to 4 i + 3 come from face i, so
// labels and origins follow by division. docs/theory/imprint.md, "Processing". Cost: linear; memory
// for the new mesh, four times the old one.
#include "defects/surface/subdivision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/error.h"
#include "core/units.h"
#include "defects/surface/edge_bisection.h"
#include "defects/surface/half_edges.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// The vertex or normal number of the middle of every half edge.
using Middles = std::vector<std::int32_t>;

void check_size(const TriangleMesh& mesh) {
  constexpr std::size_t kMaxTriangles = std::numeric_limits<std::int32_t>::max() / 3;
  if (mesh.num_triangles() > kMaxTriangles / 4) {
    throw ConfigError("imprint.processing.levels",
                      fmt::format("{} triangles cannot be cut in four, at most {} "
                                  "can be handled",
                                  mesh.num_triangles(),
                                  kMaxTriangles));
  }
}

/// The half edges of all faces at the edge of one, itself first.
void collect_edge(const TriangleMesh& mesh,
                  const VertexCorners& corners,
                  std::int32_t half,
                  std::vector<std::int32_t>& halves) {
  const std::int32_t a = origin_of(mesh, half);
  const std::int32_t b = origin_of(mesh, next_corner(half));
  halves.clear();
  for (const std::int32_t other : corners.of(a)) {
    if (origin_of(mesh, next_corner(other)) == b) {
      halves.push_back(other);
    }
  }
  for (const std::int32_t other : corners.of(b)) {
    if (origin_of(mesh, next_corner(other)) == a) {
      halves.push_back(other);
    }
  }
}

/// Adds the vertices in the middle of all edges.
Middles add_edge_points(const TriangleMesh& mesh,
                        const VertexCorners& corners,
                        std::span<const ExactPatch> patches,
                        std::vector<Vector3d>& vertices_mm) {
  Middles middle(3 * mesh.num_triangles(), -1);
  std::vector<std::int32_t> halves;
  std::vector<std::int32_t> patch_ids;
  for (std::size_t i = 0; i < middle.size(); ++i) {
    if (middle[i] >= 0) {
      continue;
    }
    const auto half = static_cast<std::int32_t>(i);
    collect_edge(mesh, corners, half, halves);
    patch_ids.clear();
    for (const std::int32_t other : halves) {
      patch_ids.push_back(mesh.patch_of(at(other / 3)));
      middle[at(other)] = static_cast<std::int32_t>(vertices_mm.size());
    }
    vertices_mm.push_back(edge_point(patches,
                                     patch_ids,
                                     mesh.vertices_mm[at(origin_of(mesh, half))],
                                     mesh.vertices_mm[at(origin_of(mesh, next_corner(half)))]));
  }
  return middle;
}

/// Puts new vertices back onto the middle of their edges where an exact surface would turn a slim
/// face over.
void reset_turned(const TriangleMesh& mesh, const Middles& middle, TriangleMesh& out) {
  const auto turns_over = [&](std::size_t child) {
    constexpr double kMinShare = 0.02;  // of the parent's area; 1/4 without exact surfaces
    const Vector3d parent = area_vector(mesh, child / 4);
    return area_vector(out, child).dot(parent) < kMinShare * parent.squaredNorm();
  };
  for (bool is_settled = false; !is_settled;) {
    is_settled = true;
    for (std::size_t child = 0; child < out.num_triangles(); ++child) {
      if (!turns_over(child)) {
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3d p = 0.5 * (mesh.vertex(child / 4, k) + mesh.vertex(child / 4, (k + 1) % 3));
        Vector3d& q = out.vertices_mm[at(middle[3 * (child / 4) + k])];
        is_settled = is_settled && q == p;
        q = p;
      }
    }
  }
}

/// Adds the normals in the middle of all edges; faces that share both ends' normals share it.
Middles add_edge_normals(const TriangleMesh& mesh,
                         const std::vector<std::int32_t>& opposite,
                         std::span<const ExactPatch> patches,
                         const Middles& vertex,
                         TriangleMesh& out) {
  Middles middle(3 * mesh.num_triangles(), -1);
  const auto normal_at = [&](std::int32_t corner) {
    return mesh.corner_normals[at(corner / 3)][at(corner % 3)];
  };
  for (std::size_t i = 0; i < middle.size(); ++i) {
    if (middle[i] >= 0) {
      continue;
    }
    const auto half = static_cast<std::int32_t>(i);
    const std::int32_t a = normal_at(half);
    const std::int32_t b = normal_at(next_corner(half));
    middle[i] = static_cast<std::int32_t>(out.normals.size());
    out.normals.push_back(edge_normal(patches,
                                      mesh.patch_of(i / 3),
                                      out.vertices_mm[at(vertex[i])],
                                      mesh.normals[at(a)],
                                      mesh.normals[at(b)]));
    const std::int32_t other = opposite[i];
    if (other >= 0 && normal_at(other) == b && normal_at(next_corner(other)) == a) {
      middle[at(other)] = middle[i];
    }
  }
  return middle;
}

void append_children(std::vector<Triangle>& faces,
                     const Triangle& t,
                     const Middles& m,
                     std::size_t i) {
  const std::int32_t ab = m[3 * i];
  const std::int32_t bc = m[3 * i + 1];
  const std::int32_t ca = m[3 * i + 2];
  faces.push_back({t[0], ab, ca});
  faces.push_back({ab, t[1], bc});
  faces.push_back({ca, bc, t[2]});
  faces.push_back({ab, bc, ca});
}

/// What Loop's rule has to know of an edge.
class SharpEdges {
 public:
  SharpEdges(const TriangleMesh& mesh, std::span<const std::int32_t> labels, double crease_rad)
      : mesh_(mesh), corners_(mesh), opposite_(opposite_half_edges(mesh, corners_)) {
    is_sharp_.resize(opposite_.size());
    for (std::size_t i = 0; i < opposite_.size(); ++i) {
      const std::int32_t other = opposite_[i];
      const bool is_sharp = other < 0 || labels[i / 3] != labels[at(other / 3)] ||
                            mesh.patch_of(i / 3) >= 0 || mesh.patch_of(at(other / 3)) >= 0 ||
                            angle_between_faces(mesh, i / 3, at(other / 3)) > crease_rad;
      is_sharp_[i] = is_sharp ? 1 : 0;
    }
  }

  const VertexCorners& corners() const { return corners_; }

  std::int32_t opposite(std::int32_t half) const { return opposite_[at(half)]; }

  bool is_sharp(std::int32_t half) const { return is_sharp_[at(half)] != 0; }

  const Vector3d& place(std::int32_t corner) const {
    return mesh_.vertices_mm[at(origin_of(mesh_, corner))];
  }

  std::int32_t vertex(std::int32_t corner) const { return origin_of(mesh_, corner); }

  bool is_exact(std::int32_t corner) const { return mesh_.patch_of(at(corner / 3)) >= 0; }

 private:
  const TriangleMesh& mesh_;
  VertexCorners corners_;
  std::vector<std::int32_t> opposite_;
  std::vector<char> is_sharp_;
};

Vector3d edge_place(const SharpEdges& edges, std::int32_t half) {
  const Vector3d ends = edges.place(half) + edges.place(next_corner(half));
  const std::int32_t other = edges.opposite(half);
  return 0.375 * ends +
         0.125 * (edges.place(previous_corner(half)) + edges.place(previous_corner(other)));
}

/// The neighbours of a vertex: all, and those along sharp edges. Each once.
struct Neighbours {
  std::vector<std::int32_t> all;  ///< corners at the neighbouring vertices
  std::vector<std::int32_t> sharp;
};

void collect_neighbours(const SharpEdges& edges, std::int32_t vertex, Neighbours& found) {
  found.all.clear();
  found.sharp.clear();
  const auto add = [&](std::vector<std::int32_t>& list, std::int32_t corner) {
    const bool is_known = std::ranges::any_of(
        list, [&](std::int32_t known) { return edges.vertex(known) == edges.vertex(corner); });
    if (!is_known) {
      list.push_back(corner);
    }
  };
  for (const std::int32_t corner : edges.corners().of(vertex)) {
    add(found.all, next_corner(corner));
    add(found.all, previous_corner(corner));
    if (edges.is_sharp(corner)) {
      add(found.sharp, next_corner(corner));
    }
    if (edges.is_sharp(previous_corner(corner))) {
      add(found.sharp, previous_corner(corner));
    }
  }
}

Vector3d vertex_place(const SharpEdges& edges, const Vector3d& p, const Neighbours& around) {
  if (around.sharp.size() > 2 || around.all.empty()) {
    return p;
  }
  if (around.sharp.size() == 2) {
    return 0.75 * p + 0.125 * (edges.place(around.sharp[0]) + edges.place(around.sharp[1]));
  }
  const auto count = static_cast<double>(around.all.size());
  const double c = 0.375 + 0.25 * std::cos(2.0 * kPi / count);
  const double weight = (0.625 - c * c) / count;
  Vector3d sum = Vector3d::Zero();
  for (const std::int32_t corner : around.all) {
    sum += edges.place(corner);
  }
  return (1.0 - count * weight) * p + weight * sum;
}

}  // namespace

namespace {

void subdivide_normals(const TriangleMesh& mesh,
                       const VertexCorners& corners,
                       std::span<const ExactPatch> patches,
                       const Middles& vertex,
                       TriangleMesh& out) {
  const Middles normal =
      add_edge_normals(mesh, opposite_half_edges(mesh, corners), patches, vertex, out);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    append_children(out.corner_normals, mesh.corner_normals[i], normal, i);
  }
}

}  // namespace

Subdivided subdivide_midpoint(const TriangleMesh& mesh,
                              std::span<const std::int32_t> labels,
                              std::span<const ExactPatch> patches) {
  GLINT_CHECK(labels.size() == mesh.num_triangles(), "one label a face");
  check_size(mesh);
  const std::size_t count = 4 * mesh.num_triangles();
  const VertexCorners corners(mesh);
  Subdivided out;
  out.mesh.vertices_mm = mesh.vertices_mm;
  out.mesh.normals = mesh.normals;
  const Middles vertex = add_edge_points(mesh, corners, patches, out.mesh.vertices_mm);
  out.mesh.triangles.reserve(count);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    append_children(out.mesh.triangles, mesh.triangles[i], vertex, i);
    out.labels.insert(out.labels.end(), 4, labels[i]);
    out.origin.insert(out.origin.end(), 4, static_cast<std::int32_t>(i));
    out.mesh.patch.insert(out.mesh.patch.end(), mesh.patch.empty() ? 0 : 4, mesh.patch_of(i));
  }
  reset_turned(mesh, vertex, out.mesh);
  if (!mesh.corner_normals.empty()) {
    subdivide_normals(mesh, corners, patches, vertex, out.mesh);
  }
  return out;
}

std::vector<Vector3d> loop_places(const TriangleMesh& mesh,
                                  std::span<const std::int32_t> labels,
                                  const Subdivided& midpoint,
                                  double crease_rad) {
  const SharpEdges edges(mesh, labels, crease_rad);
  std::vector<Vector3d> places = midpoint.mesh.vertices_mm;
  Neighbours around;
  for (std::size_t i = 0; i < mesh.vertices_mm.size(); ++i) {
    const auto vertex = static_cast<std::int32_t>(i);
    const bool is_exact = std::ranges::any_of(
        edges.corners().of(vertex), [&](std::int32_t corner) { return edges.is_exact(corner); });
    if (!is_exact) {
      collect_neighbours(edges, vertex, around);
      places[i] = vertex_place(edges, mesh.vertices_mm[i], around);
    }
  }
  for (std::size_t i = 0; i < 3 * mesh.num_triangles(); ++i) {
    const auto half = static_cast<std::int32_t>(i);
    if (!edges.is_sharp(half)) {
      // The second corner of the child at corner i % 3 is the middle of the edge that begins there.
      const std::size_t k = i % 3;
      const std::int32_t vertex = midpoint.mesh.triangles[4 * (i / 3) + k][(k + 1) % 3];
      places[at(vertex)] = edge_place(edges, half);
    }
  }
  return places;
}

}  // namespace glint

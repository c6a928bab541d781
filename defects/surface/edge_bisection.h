// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::defects::surface: a mesh made finer in places by bisecting longest edges,
// and where a new vertex on an edge lies.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "defects/surface/half_edges.h"
#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/part/exact_surface.h"

namespace glint {

/// The place of a new vertex on the edge from a to b: on all exact surfaces of the faces there, or
/// in the middle when one of the faces is free.
/// @param patch_ids  of the faces at the edge, -1 for free ones; repetition allowed
Eigen::Vector3d edge_point(std::span<const ExactPatch> patches,
                           std::span<const std::int32_t> patch_ids,
                           const Eigen::Vector3d& a_mm,
                           const Eigen::Vector3d& b_mm);

/// The shading normal of a new vertex: of the exact surface, or between the normals of the ends.
Eigen::Vector3d edge_normal(std::span<const ExactPatch> patches,
                            std::int32_t patch,
                            const Eigen::Vector3d& point_mm,
                            const Eigen::Vector3d& normal_a,
                            const Eigen::Vector3d& normal_b);

/// Bisects faces across their longest edges; neighbours are bisected with them, so that a closed
/// mesh stays closed. A face keeps its number as long as it is whole; of a face that is bisected
/// one half keeps the number and the other is appended. Cost: one pass over the mesh, then only the
/// faces that are touched.
///
/// Source: M.-C. Rivara, "New longest-edge algorithms for the refinement and/or improvement of
/// unstructured triangulations", Int. J. Numer. Meth. Engng. 40, 1997 (propagation path).
class EdgeBisection {
 public:
  /// The longest edge [mm] a face may have; infinite where it may stay as it is.
  using AllowedEdge = std::function<double(std::int32_t face)>;

  /// mesh must outlive this and have shading normals for every corner, which new corners then get
  /// too, or none at all; labels and origin hold one entry a face.
  EdgeBisection(TriangleMesh& mesh,
                std::vector<std::int32_t>& labels,
                std::vector<std::int32_t>& origin,
                std::span<const ExactPatch> patches);

  /// Bisects the given faces and what comes of them until no edge is too long. Returns all faces
  /// that were given or came to be or were cut, in ascending order.
  std::vector<std::int32_t> refine(std::vector<std::int32_t> faces, const AllowedEdge& allowed);

  /// The faces around a vertex, in ascending order, as far as they existed before.
  std::vector<std::int32_t> old_faces_at(std::int32_t vertex) const;

 private:
  struct Edge {
    std::int32_t from = 0;
    std::int32_t to = 0;
    double squared_mm2 = 0.0;

    /// A strict order, so that two faces never disagree which of their edges is longest.
    bool is_shorter_than(const Edge& other) const;

    bool operator==(const Edge& other) const { return from == other.from && to == other.to; }
  };

  static constexpr int kNoNormal = -1;

  bool has_normals() const { return !mesh_.corner_normals.empty(); }

  Edge edge_of(std::int32_t face, std::size_t corner) const;
  Edge longest_edge(std::int32_t face) const;
  std::vector<std::int32_t>& faces_at(const Edge& edge);
  Edge end_of_path(std::int32_t face);
  void bisect(const Edge& edge);
  std::int32_t add_vertex(const Edge& edge, const std::vector<std::int32_t>& faces);
  bool keeps_faces(const Edge& edge,
                   const std::vector<std::int32_t>& faces,
                   const Eigen::Vector3d& p_mm) const;
  std::int32_t split_face(std::int32_t face, const Edge& edge, std::int32_t vertex, int normal);
  int normal_for(std::int32_t face, const Edge& edge, const Eigen::Vector3d& p_mm);

  TriangleMesh& mesh_;
  std::vector<std::int32_t>& labels_;
  std::vector<std::int32_t>& origin_;
  std::span<const ExactPatch> patches_;
  VertexCorners corners_;
  std::size_t num_old_vertices_;
  std::unordered_map<std::uint64_t, std::vector<std::int32_t>> edge_faces_;
  std::vector<std::int32_t> touched_;

  struct NewNormal {
    std::int32_t low = 0;
    std::int32_t high = 0;
    int index = 0;
  };

  std::vector<NewNormal> new_normals_;  ///< of the edge that is being bisected
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "defects/boolean/box_tree.h"
#include "defects/boolean/imprint.h"
#include "defects/boolean/patch_crossings.h"

namespace glint {

/// The part as it was at first; shared by all copies.
struct ImprintedBase {
  explicit ImprintedBase(const TriangleMesh& part);

  TriangleMesh mesh;
  BoxTree tree;
};

/// A face that an imprint adds.
struct AddedFace {
  Triangle vertices = {};
  std::int32_t label = 0;
  std::int32_t origin = -1;  ///< triangle of the part at first, -1 for a tool's
};

/// What one imprint does to the part.
struct PatchChange {
  std::vector<std::int32_t> removed;  ///< faces
  /// Get the indices num_vertices(), num_vertices() + 1, ...
  std::vector<Eigen::Vector3d> vertices_mm;
  std::vector<AddedFace> faces;
  std::vector<FloatBox> boxes;  ///< of faces
};

/// The faces and vertices of a part after some imprints. Indices never change: first those of the
/// part, then those of each imprint; what an imprint takes away is only marked.
class ImprintedMeshState {
 public:
  explicit ImprintedMeshState(const TriangleMesh& part);

  std::int32_t num_vertices() const;

  const Eigen::Vector3d& vertex(std::int32_t number) const;
  const Triangle& triangle(std::int32_t face) const;
  std::int32_t label(std::int32_t face) const;
  std::int32_t origin(std::int32_t face) const;
  std::int32_t patch(std::int32_t face) const;

  bool is_alive(std::int32_t face) const { return !is_removed_[static_cast<std::size_t>(face)]; }

  std::size_t num_alive() const { return num_alive_; }

  TestFace test_face(std::int32_t face) const;

  /// visit(face) for the faces that are there and whose boxes meet something; see BoxTree.
  template <class Overlaps, class Visit>
  void visit_if(const Overlaps& overlaps, const Visit& visit) const {
    base_->tree.visit_if(overlaps, [&](std::int32_t face) { visit_alive(face, visit); });
    for (const Block& block : blocks_) {
      block.tree->visit_if(overlaps,
                           [&](std::int32_t face) { visit_alive(block.first_face + face, visit); });
    }
  }

  /// Is a point inside the part? For an open part a guess.
  bool contains(const Eigen::Vector3d& point) const;

  void apply(const PatchChange& change);

  MeshCutout cutout(const BoundingBox& box_mm) const;
  /// What puts the faces of a cutout back that are no longer what they were.
  PatchChange change_to(const MeshCutout& finer) const;

  ImprintedMesh::Labelled result() const;
  std::size_t memory_bytes() const;

 private:
  /// The faces of one imprint.
  struct Block {
    std::int32_t first_face = 0;
    std::shared_ptr<const BoxTree> tree;
  };

  template <class Visit>
  void visit_alive(std::int32_t face, const Visit& visit) const {
    if (is_alive(face)) {
      visit(face);
    }
  }

  std::int32_t num_base_faces() const {
    return static_cast<std::int32_t>(base_->mesh.triangles.size());
  }

  std::vector<std::int32_t> renumbered_vertices(TriangleMesh& out) const;

  std::shared_ptr<const ImprintedBase> base_;
  std::vector<bool> is_removed_;
  std::vector<Eigen::Vector3d> added_vertices_mm_;
  std::vector<AddedFace> added_faces_;
  std::vector<Block> blocks_;
  std::size_t num_alive_ = 0;
};

}  // namespace glint

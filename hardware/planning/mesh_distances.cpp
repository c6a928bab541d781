// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/mesh_distances.h"

#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/distance.h>

namespace glint {
namespace {

using Tree = fcl::BVHModel<fcl::OBBRSSd>;

std::unique_ptr<Tree> tree_of(const TriangleMesh& mesh) {
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.num_triangles());
  for (const Triangle& corners : mesh.triangles) {
    triangles.emplace_back(static_cast<std::size_t>(corners[0]),
                           static_cast<std::size_t>(corners[1]),
                           static_cast<std::size_t>(corners[2]));
  }
  auto tree = std::make_unique<Tree>();
  tree->beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices_mm.size()));
  tree->addSubModel(mesh.vertices_mm, triangles);
  tree->endModel();
  tree->computeLocalAABB();
  return tree;
}

double distance_of(const Tree& first,
                   const Eigen::Isometry3d& base_from_first,
                   const Tree& second,
                   const Eigen::Isometry3d& base_from_second,
                   double enough_mm) {
  const fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  result.min_distance = enough_mm;
  return std::min(
      enough_mm,
      fcl::distance(&first, base_from_first, &second, base_from_second, request, result));
}

/// A mesh and its bounding box, both as trees.
struct Entry {
  std::unique_ptr<Tree> tree;
  std::unique_ptr<Tree> box_tree;  ///< of a large mesh
  BoundingBox box;
  Eigen::Vector3d corner_mm;  ///< any point of the mesh
};

Entry entry_of(const TriangleMesh& mesh) {
  constexpr std::size_t kLarge = 50;
  Entry entry = {.tree = tree_of(mesh),
                 .box_tree = nullptr,
                 .box = bounding_box(mesh),
                 .corner_mm = mesh.vertices_mm.front()};
  if (mesh.num_triangles() > kLarge) {
    entry.box_tree = tree_of(box_mesh(entry.box.centre_mm(), entry.box.size_mm()));
  }
  return entry;
}

}  // namespace

struct MeshDistances::Meshes {
  std::vector<Entry> entries;
  std::int64_t queries = 0;
};

MeshDistances::MeshDistances(std::span<const SolidBody> bodies)
    : meshes_(std::make_unique<Meshes>()) {
  for (const SolidBody& body : bodies) {
    meshes_->entries.push_back(entry_of(body.mesh));
  }
}

MeshDistances::~MeshDistances() = default;
MeshDistances::MeshDistances(MeshDistances&& other) noexcept = default;
MeshDistances& MeshDistances::operator=(MeshDistances&& other) noexcept = default;

double MeshDistances::distance_mm(std::size_t first,
                                  const Eigen::Isometry3d& base_from_first,
                                  std::size_t second,
                                  const Eigen::Isometry3d& base_from_second,
                                  double enough_mm) const {
  ++meshes_->queries;
  return distance_of(*meshes_->entries[first].tree,
                     base_from_first,
                     *meshes_->entries[second].tree,
                     base_from_second,
                     enough_mm);
}

double MeshDistances::distance_to_box_mm(std::size_t first,
                                         const Eigen::Isometry3d& base_from_first,
                                         std::size_t second,
                                         const Eigen::Isometry3d& base_from_second,
                                         double enough_mm) const {
  const Entry& large = meshes_->entries[first];
  const Entry& other = meshes_->entries[second];
  const Eigen::Vector3d corner_mm =
      base_from_first.inverse() * (base_from_second * other.corner_mm);
  const bool is_within = (corner_mm.array() >= large.box.min_mm.array()).all() &&
                         (corner_mm.array() <= large.box.max_mm.array()).all();
  ++meshes_->queries;
  return is_within
             ? 0.0
             : distance_of(
                   *large.box_tree, base_from_first, *other.tree, base_from_second, enough_mm);
}

bool MeshDistances::is_large(std::size_t body) const {
  return meshes_->entries[body].box_tree != nullptr;
}

std::int64_t MeshDistances::num_queries() const {
  return meshes_->queries;
}

}  // namespace glint

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

}  // namespace

struct MeshDistances::Meshes {
  std::vector<std::unique_ptr<Tree>> trees;
  std::int64_t queries = 0;
};

MeshDistances::MeshDistances(std::span<const SolidBody> bodies)
    : meshes_(std::make_unique<Meshes>()) {
  for (const SolidBody& body : bodies) {
    meshes_->trees.push_back(tree_of(body.mesh));
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
  const fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  result.min_distance = enough_mm;
  ++meshes_->queries;
  return std::min(enough_mm,
                  fcl::distance(meshes_->trees[first].get(),
                                base_from_first,
                                meshes_->trees[second].get(),
                                base_from_second,
                                request,
                                result));
}

std::int64_t MeshDistances::num_queries() const {
  return meshes_->queries;
}

}  // namespace glint

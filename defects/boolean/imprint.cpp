// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/boolean/imprint.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/error.h"
#include "defects/boolean/patch.h"

namespace glint {

std::string_view outcome_text(ImprintOutcome outcome) {
  switch (outcome) {
    case ImprintOutcome::kDone:
      return "the imprint was made";
    case ImprintOutcome::kNoContact:
      return "the tool does not reach into the part";
    case ImprintOutcome::kSwallowed:
      return "the tool lies wholly inside the part";
    case ImprintOutcome::kSwallowsPart:
      return "the part lies wholly inside the tool";
    case ImprintOutcome::kOpenSeam:
      return "the cut does not close: the part has a hole there, or faces of tool and part lie in "
             "one plane";
    case ImprintOutcome::kSelfIntersection:
      return "the imprinted surface would cross itself";
    case ImprintOutcome::kDegenerate:
      return "the cut makes a face without area";
    case ImprintOutcome::kBrokenPatch:
      return "the part's surface crosses itself or is not a manifold where the tool intersects it";
    case ImprintOutcome::kBrokenTool:
      return "the tool is not closed or crosses itself";
    case ImprintOutcome::kTooLittle:
      return "the tool changes less volume than it must";
    case ImprintOutcome::kBreaksThrough:
      return "the tool breaks through another side of the part or cuts a piece off";
  }
  return "unknown";
}

ImprintedMesh::ImprintedMesh(const TriangleMesh& part)
    : state_(std::make_unique<ImprintedMeshState>(part)) {}

ImprintedMesh::ImprintedMesh(const ImprintedMesh& other)
    : state_(std::make_unique<ImprintedMeshState>(*other.state_)) {}

ImprintedMesh::ImprintedMesh(ImprintedMesh&& other) noexcept = default;

ImprintedMesh& ImprintedMesh::operator=(const ImprintedMesh& other) {
  if (this != &other) {
    state_ = std::make_unique<ImprintedMeshState>(*other.state_);
  }
  return *this;
}

ImprintedMesh& ImprintedMesh::operator=(ImprintedMesh&& other) noexcept = default;

ImprintedMesh::~ImprintedMesh() = default;

ImprintResult ImprintedMesh::imprint(const TriangleMesh& tool,
                                     std::int32_t label,
                                     ImprintOperation operation,
                                     const ImprintLimits& limits) {
  GLINT_CHECK(label > 0, "labels of defects count from 1");
  const PatchResult cut = cut_patch(*state_, tool, label, operation, limits);
  if (cut.result.is_done()) {
    state_->apply(cut.change);
  }
  return cut.result;
}

MeshCutout ImprintedMesh::cutout(const BoundingBox& box_mm) const {
  return state_->cutout(box_mm);
}

void ImprintedMesh::replace(const MeshCutout& finer) {
  state_->apply(state_->change_to(finer));
}

ImprintedMesh::Labelled ImprintedMesh::result() const {
  return state_->result();
}

std::size_t ImprintedMesh::num_triangles() const {
  return state_->num_alive();
}

std::size_t ImprintedMesh::memory_bytes() const {
  return state_->memory_bytes();
}

double jitter_size(int retry) {
  return std::min(3e-2, 1e-4 * std::pow(3.0, retry - 1));
}

TriangleMesh jittered(const TriangleMesh& tool, double size, Rng& rng) {
  const BoundingBox box = bounding_box(tool);
  Eigen::Vector3d shift;
  Eigen::Vector3d angles_rad;
  for (int i = 0; i < 3; ++i) {
    shift[i] = rng.uniform(-1.0, 1.0);
    angles_rad[i] = rng.uniform(-1.0, 1.0);
  }
  const double angle_rad = size * angles_rad.norm();
  RigidTransform moved;
  moved.rotation = Eigen::AngleAxisd(angle_rad, angles_rad.normalized()).toRotationMatrix();
  moved.translation_mm =
      box.centre_mm() - moved.rotation * box.centre_mm() + size * box.size_mm().norm() * shift;
  TriangleMesh result = tool;
  transform(result, moved);
  return result;
}

}  // namespace glint

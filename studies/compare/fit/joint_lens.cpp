// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/fit/joint_lens.h"

#include <algorithm>
#include <array>

#include <ceres/ceres.h>

#include "studies/compare/fit/edge_cost.h"

namespace glint {
namespace {

constexpr std::size_t kPoseParameters = 6;
constexpr std::size_t kLensParameters = kCauseParameters - kPoseParameters;

using PoseChange = std::array<double, kPoseParameters>;
using LensChange = std::array<double, kLensParameters>;

/// An edge's offset under the pose of its view and the lens of all.
struct JointEdgeCost {
  compare_detail::EdgeCost edge;

  template <class T>
  bool operator()(const T* pose, const T* lens, T* rest) const {
    std::array<T, kCauseParameters> change;
    std::copy_n(pose, kPoseParameters, change.begin());
    std::copy_n(lens, kLensParameters, change.begin() + kPoseParameters);
    return edge(change.data(), rest);
  }
};

using JointCostFunction =
    ceres::AutoDiffCostFunction<JointEdgeCost, 1, kPoseParameters, kLensParameters>;

/// Those of the lens that stay as they are.
std::vector<int> fixed_of(std::span<const CauseParameter> lens) {
  std::vector<int> fixed;
  for (std::size_t k = 0; k < kLensParameters; ++k) {
    const auto parameter = static_cast<CauseParameter>(kPoseParameters + k);
    if (std::ranges::find(lens, parameter) == lens.end()) {
      fixed.push_back(static_cast<int>(k));
    }
  }
  return fixed;
}

/// In units of its noise, so that a blurred view does not count as much as a sharp one.
void add_edges(const LensView& view,
               const PinholeIntrinsics& camera,
               PoseChange& pose,
               LensChange& lens,
               ceres::Problem& problem) {
  constexpr double kOutlier = 2.0;  ///< in units of noise
  constexpr double kMinNoise_px = 0.01;
  for (const SpaceEdge& edge : view.edges) {
    compare_detail::EdgeCost cost = compare_detail::cost_of(camera, view.middle_mm, edge);
    cost.root_weight = 1.0 / std::max(view.noise_px, kMinNoise_px);
    problem.AddResidualBlock(new JointCostFunction(new JointEdgeCost{cost}),
                             new ceres::HuberLoss(kOutlier),
                             pose.data(),
                             lens.data());
  }
}

void solve(ceres::Problem& problem) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;  // the same bytes for any number of threads
  options.max_num_iterations = 100;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
}

}  // namespace

std::vector<CauseVector> fit_joint_lens(std::span<const LensView> views,
                                        const PinholeIntrinsics& camera,
                                        std::span<const CauseParameter> lens) {
  std::vector<PoseChange> poses(views.size());
  LensChange common = {};
  ceres::Problem problem;
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::copy_n(views[i].changes.begin(), kPoseParameters, poses[i].begin());
    add_edges(views[i], camera, poses[i], common, problem);
  }
  const std::vector<int> fixed = fixed_of(lens);
  if (problem.HasParameterBlock(common.data())) {
    if (fixed.size() == kLensParameters) {
      problem.SetParameterBlockConstant(common.data());
    } else if (!fixed.empty()) {
      problem.SetManifold(common.data(), new ceres::SubsetManifold(kLensParameters, fixed));
    }
    solve(problem);
  }
  std::vector<CauseVector> changes(views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::ranges::copy(poses[i], changes[i].begin());
    std::ranges::copy(common, changes[i].begin() + kPoseParameters);
  }
  return changes;
}

}  // namespace glint

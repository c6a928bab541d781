// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/view_influence.h"

#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>

#include "hardware/calibration_review/view_information.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ViewInfluence influence_of(const Bundle& bundle, const MatrixXd& whole, const VectorXd& move) {
  ViewInfluence influence;
  influence.cook = move.dot(whole * move) / static_cast<double>(std::max<Index>(1, move.size()));
  Index at = 0;
  LensVector lens = LensVector::Zero();
  for (std::size_t i = 0; i < kLensSize; ++i) {
    if (bundle.is_free[i]) {
      lens[static_cast<Index>(i)] = move[at++];
    }
  }
  influence.focal_px = lens.head<2>().cwiseAbs().maxCoeff();
  influence.center_px = lens.segment<2>(2).norm();
  if (bundle.are_poses_free) {
    influence.rotation_rad = move.segment<3>(at).norm();
    influence.translation_mm = move.segment<3>(at + 3).norm();
  }
  return influence;
}

/// How far the unknowns move when a view is left out; none where the others do not fix them.
std::optional<VectorXd> step_without(const SharedInformation& one,
                                     const MatrixXd& whole,
                                     const VectorXd& gradient) {
  // Scaled, as the unknowns have different units.
  const VectorXd scale = whole.diagonal().array().max(1e-300).rsqrt();
  const MatrixXd rest = scale.asDiagonal() * (whole - one.hessian) * scale.asDiagonal();
  const Eigen::LDLT<MatrixXd> factor(rest);
  const VectorXd step =
      -scale.cwiseProduct(factor.solve(scale.cwiseProduct(gradient - one.gradient)));
  if (scale.size() > 0 && !(factor.vectorD().minCoeff() > 1e-14)) {
    return std::nullopt;
  }
  return step;
}

}  // namespace

std::vector<ViewInfluence> view_influences(const Bundle& solved) {
  std::vector<SharedInformation> views;
  const Index size = num_shared(solved);
  MatrixXd whole = MatrixXd::Zero(size, size);
  VectorXd gradient = VectorXd::Zero(size);
  for (const BundleView& view : solved.views) {
    const SharedInformation& one = views.emplace_back(view_information(solved, view));
    whole += one.hessian;
    gradient += one.gradient;
  }
  add_lens_prior(solved, whole, gradient);
  std::vector<ViewInfluence> result;
  for (const SharedInformation& one : views) {
    const auto step = step_without(one, whole, gradient);
    constexpr double kNone = std::numeric_limits<double>::infinity();
    result.push_back(step.has_value() ? influence_of(solved, whole, *step)
                                      : ViewInfluence{kNone, kNone, kNone, kNone, kNone});
  }
  return result;
}

}  // namespace glint

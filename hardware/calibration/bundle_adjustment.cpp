// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <ceres/ceres.h>
#include <glog/logging.h>

namespace glint {
namespace {

/// Ceres tells of steps that fail through glog, to stderr and whatever logging_type is; we try
/// others and tell what comes of it. @return true
bool silence_glog() {
  FLAGS_minloglevel = google::GLOG_FATAL;
  return true;
}

/// The corners of one picture. Blocks: intrinsics, hand-eye, board, error of the robot.
class ViewCost final : public ceres::CostFunction {
 public:
  ViewCost(const Bundle& bundle, const BundleView& view) : bundle_(bundle), view_(view) {
    set_num_residuals(static_cast<int>(2 * view.corners.board_mm.size()));
    *mutable_parameter_block_sizes() = {9, 6, 6, 6};
    scales_.resize(num_residuals());
    for (Eigen::Index i = 0; i < view.weights.size(); ++i) {
      scales_.segment<2>(2 * i).setConstant(std::sqrt(view.weights[i]) / bundle.noise.corner_px);
    }
    damped_ = 1.0 - bundle.noise.corner_px / bundle.noise.whole_pattern_px();
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const LensVector lens = Eigen::Map<const LensVector>(parameters[0]);
    const ChainIncrement increment{.hand_eye = Eigen::Map<const Vector6d>(parameters[1]),
                                   .board = Eigen::Map<const Vector6d>(parameters[2]),
                                   .error = Eigen::Map<const Vector6d>(parameters[3])};
    ViewSystem system;
    if (!evaluate_view(bundle_, view_, lens, increment, jacobians != nullptr, system)) {
      return false;
    }
    Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = whitened(system.residual_px);
    if (jacobians != nullptr) {
      write(system.by_lens, jacobians[0]);
      write(system.by_hand_eye, jacobians[1]);
      write(system.by_board, jacobians[2]);
      write(system.by_error, jacobians[3]);
    }
    return true;
  }

 private:
  template <class Matrix>
  void write(const Matrix& by, double* rows) const {
    using RowMajor =
        Eigen::Matrix<double, Eigen::Dynamic, Matrix::ColsAtCompileTime, Eigen::RowMajor>;
    if (rows != nullptr) {
      Eigen::Map<RowMajor>(rows, by.rows(), by.cols()) = whitened(by);
    }
  }

  /// In units of the noise: what looks like a movement of the board counts less.
  template <class Matrix>
  Matrix whitened(const Matrix& plain) const {
    Matrix result = scales_.asDiagonal() * plain;
    if (view_.patterns.rows() == result.rows()) {
      const Eigen::MatrixXd along = view_.patterns.transpose() * result;
      result -= damped_ * view_.patterns * along;
    }
    return result;
  }

  const Bundle& bundle_;
  const BundleView& view_;
  Eigen::VectorXd scales_;
  double damped_ = 0.0;  ///< share of the patterns that is taken away
};

/// (x - mean) / sigma of each number; one without a limit (sigma infinite, or 0 as it does not
/// move) is left alone.
class NormalCost final : public ceres::CostFunction {
 public:
  NormalCost(Eigen::VectorXd mean, const Eigen::VectorXd& sigma)
      : mean_(std::move(mean)), scale_((sigma.array() > 0.0).select(sigma.cwiseInverse(), 0.0)) {
    set_num_residuals(static_cast<int>(mean_.size()));
    *mutable_parameter_block_sizes() = {static_cast<int>(mean_.size())};
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const Eigen::Index size = mean_.size();
    const Eigen::Map<const Eigen::VectorXd> at(parameters[0], size);
    Eigen::Map<Eigen::VectorXd>(residuals, size) = scale_.cwiseProduct(at - mean_);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::MatrixXd>(jacobians[0], size, size) = scale_.asDiagonal();
    }
    return true;
  }

 private:
  Eigen::VectorXd mean_;
  Eigen::VectorXd scale_;
};

/// What the solver moves.
struct Unknowns {
  LensVector lens;
  Vector6d hand_eye = Vector6d::Zero();
  Vector6d board = Vector6d::Zero();
  std::vector<Vector6d> errors;
};

void fix_parts(const Bundle& bundle, Unknowns& unknowns, ceres::Problem& problem) {
  std::vector<int> fixed;
  for (std::size_t i = 0; i < kLensSize; ++i) {
    if (!bundle.is_free[i]) {
      fixed.push_back(static_cast<int>(i));
    }
  }
  if (fixed.size() == kLensSize) {
    problem.SetParameterBlockConstant(unknowns.lens.data());
  } else if (!fixed.empty()) {
    problem.SetManifold(unknowns.lens.data(), new ceres::SubsetManifold(kLensSize, fixed));
  }
  if (!bundle.are_poses_free) {
    problem.SetParameterBlockConstant(unknowns.hand_eye.data());
    problem.SetParameterBlockConstant(unknowns.board.data());
  }
}

void add_costs(const Bundle& bundle, Unknowns& unknowns, ceres::Problem& problem) {
  const NoiseSizes& noise = bundle.noise;
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(noise.robot_rad), Eigen::Vector3d::Constant(noise.robot_mm);
  const bool has_limits = noise.robot_rad > 0.0 && noise.robot_mm > 0.0;
  for (std::size_t i = 0; i < bundle.views.size(); ++i) {
    double* error = unknowns.errors[i].data();
    problem.AddResidualBlock(new ViewCost(bundle, bundle.views[i]),
                             nullptr,
                             unknowns.lens.data(),
                             unknowns.hand_eye.data(),
                             unknowns.board.data(),
                             error);
    if (has_limits) {
      problem.AddResidualBlock(new NormalCost(Vector6d::Zero(), sigma), nullptr, error);
    }
  }
  if (bundle.lens_prior.has_value()) {
    problem.AddResidualBlock(new NormalCost(bundle.lens_prior->mean, bundle.lens_prior->sigma),
                             nullptr,
                             unknowns.lens.data());
  }
}

ceres::Solver::Options options_for(Unknowns& unknowns) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  // Steps of Gauss and Newton from the first one on: most starts are near their minimum, and a
  // small region creeps along what the pictures hardly tell. Steps that fail shrink it quickly,
  // also those that leave corners behind the camera, of which five in a row would end the search.
  options.initial_trust_region_radius = 1e10;
  options.max_num_consecutive_invalid_steps = 12;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (Vector6d& error : unknowns.errors) {
    ordering->AddElementToGroup(error.data(), 0);
  }
  for (double* shared : {unknowns.lens.data(), unknowns.hand_eye.data(), unknowns.board.data()}) {
    ordering->AddElementToGroup(shared, 1);
  }
  options.linear_solver_ordering = ordering;
  return options;
}

void take_solution(const Unknowns& unknowns, Bundle& bundle) {
  bundle.lens = unknowns.lens;
  bundle.poses.hand_eye = bundle.poses.hand_eye * motion_of(unknowns.hand_eye);
  bundle.poses.board = bundle.poses.board * motion_of(unknowns.board);
  for (std::size_t i = 0; i < bundle.views.size(); ++i) {
    bundle.views[i].error = unknowns.errors[i];
  }
}

}  // namespace

AdjustmentSummary adjust_bundle(Bundle& bundle) {
  [[maybe_unused]] static const bool is_silent = silence_glog();
  if (!std::ranges::all_of(bundle.views, [&](const BundleView& view) {
        return std::isfinite(rms_px(bundle, view));
      })) {
    return {};
  }
  Unknowns unknowns{.lens = bundle.lens};
  for (const BundleView& view : bundle.views) {
    unknowns.errors.push_back(view.error);
  }
  ceres::Problem problem;
  add_costs(bundle, unknowns, problem);
  fix_parts(bundle, unknowns, problem);
  ceres::Solver::Summary summary;
  ceres::Solve(options_for(unknowns), &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    return {};
  }
  take_solution(unknowns, bundle);
  return {.has_converged = summary.termination_type == ceres::CONVERGENCE,
          .iterations = static_cast<int>(summary.iterations.size()),
          .cost = summary.final_cost};
}

}  // namespace glint

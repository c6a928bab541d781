// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/camera_errors.h"

#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace glint::validate_detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kLens = 9;
constexpr Index kMotion = 6;
/// Of differences by fx fy cx cy [px of whole pictures] k1 k2 k3 p1 p2, by turn [rad] and shift
/// [mm].
constexpr std::array<double, kLens> kLensSteps = {1.0, 1.0, 0.5, 0.5, 0.02, 0.1, 0.5, 1e-3, 1e-3};
constexpr double kTurnStep = 1.7e-3;
constexpr double kShiftStep = 0.5;
constexpr double kLeastOfStep = 1e-3;  ///< of a step: errors that are smaller do nothing

double step_of_number(Index i) {
  return i < kLens                   ? kLensSteps[static_cast<std::size_t>(i)]
         : (i - kLens) % kMotion < 3 ? kTurnStep
                                     : kShiftStep;
}

/// The slopes within the rows of one view.
GreyHalves of_view(const GreyHalves& slopes, const ViewRows& view) {
  GreyHalves some = {VectorXd::Zero(slopes[0].size()), VectorXd::Zero(slopes[1].size())};
  for (std::size_t half = 0; half < 2; ++half) {
    some[half].segment(view.rows.first, view.rows.count) =
        slopes[half].segment(view.rows.first, view.rows.count);
  }
  return some;
}

}  // namespace

VectorXd added_variance(const GreySystem& system,
                        const GreyHalves& left,
                        std::span<const GreyHalves> by,
                        const MatrixXd& covariance) {
  const StepSolver solver(system, left);
  MatrixXd steps(static_cast<Index>(system.numbers.size()), static_cast<Index>(by.size()));
  for (std::size_t i = 0; i < by.size(); ++i) {
    steps.col(static_cast<Index>(i)) = solver.step(by[i]);
  }
  return (steps * covariance).cwiseProduct(steps).rowwise().sum().cwiseMax(0.0);
}

void add_camera_errors(GreyProblem& problem,
                       const GreyState& state,
                       const GreySystem& system,
                       const GreyHalves& left,
                       const MatrixXd& covariance,
                       VectorXd& sigma) {
  std::vector<GreyHalves> slopes;
  std::vector<Index> numbers;
  if (covariance.size() == 0) {
    return;
  }
  const auto matters = [&covariance](Index i) {
    return std::sqrt(covariance(i, i)) > kLeastOfStep * step_of_number(i);
  };
  for (Index i = 0; i < kLens; ++i) {
    if (matters(i)) {
      CameraChange change;
      change.lens[i] = step_of_number(i);
      slopes.push_back(problem.camera_slope(state, change, step_of_number(i)));
      numbers.push_back(i);
    }
  }
  for (Index k = 0; k < kMotion; ++k) {
    CameraChange change;
    change.motion[k] = step_of_number(kLens + k);
    const GreyHalves all = problem.camera_slope(state, change, change.motion[k]);
    for (const ViewRows& view : problem.model().view_rows()) {
      const Index number = kLens + kMotion * view.pose + k;
      if (view.pose >= 0 && number < covariance.rows() && matters(number)) {
        slopes.push_back(of_view(all, view));
        numbers.push_back(number);
      }
    }
  }
  sigma = (sigma.cwiseAbs2() + added_variance(system, left, slopes, covariance(numbers, numbers)))
              .cwiseSqrt();
}

}  // namespace glint::validate_detail

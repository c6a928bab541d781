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
constexpr double kMinOfStep = 1e-3;  ///< of a step: errors that are smaller do nothing

double step_of_number(Index i) {
  return i < kLens                   ? kLensSteps[static_cast<std::size_t>(i)]
         : (i - kLens) % kMotion < 3 ? kTurnStep
                                     : kShiftStep;
}

/// The derivatives within the rows of one view.
GreyHalves of_view(const GreyHalves& derivatives, const ViewRows& view) {
  GreyHalves some = {VectorXd::Zero(derivatives[0].size()), VectorXd::Zero(derivatives[1].size())};
  for (std::size_t half = 0; half < 2; ++half) {
    some[half].segment(view.rows.first, view.rows.count) =
        derivatives[half].segment(view.rows.first, view.rows.count);
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
  std::vector<GreyHalves> derivatives;
  std::vector<Index> numbers;
  if (covariance.size() == 0) {
    return;
  }
  const auto matters = [&covariance](Index i) {
    return std::sqrt(covariance(i, i)) > kMinOfStep * step_of_number(i);
  };
  for (Index i = 0; i < kLens; ++i) {
    if (matters(i)) {
      CameraChange change;
      change.lens[i] = step_of_number(i);
      derivatives.push_back(problem.camera_derivative(state, change, step_of_number(i)));
      numbers.push_back(i);
    }
  }
  for (Index k = 0; k < kMotion; ++k) {
    CameraChange change;
    change.motion[k] = step_of_number(kLens + k);
    const GreyHalves all = problem.camera_derivative(state, change, change.motion[k]);
    for (const ViewRows& view : problem.model().view_rows()) {
      const Index number = kLens + kMotion * view.pose + k;
      if (view.pose >= 0 && number < covariance.rows() && matters(number)) {
        derivatives.push_back(of_view(all, view));
        numbers.push_back(number);
      }
    }
  }
  sigma =
      (sigma.cwiseAbs2() + added_variance(system, left, derivatives, covariance(numbers, numbers)))
          .cwiseSqrt();
}

}  // namespace glint::validate_detail

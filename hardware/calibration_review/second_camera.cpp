// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/second_camera.h"

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

#include "hardware/calibration_review/view_information.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kLeastViews = 4;
constexpr double kLeastExplained = 0.5;

/// What some views say of the intrinsics.
struct Part {
  MatrixXd hessian;
  VectorXd gradient;

  /// To the intrinsics that fit these views best.
  VectorXd step() const {
    const VectorXd scale = hessian.diagonal().array().max(1e-300).rsqrt();
    MatrixXd scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
    scaled.diagonal().array() += 1e-10;  // for what these views do not tell
    return -scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(gradient)));
  }
};

/// Sum of the squared residuals over the corners' variance.
double sum_of_squares(const Bundle& bundle) {
  double sum = 0.0;
  for (const BundleView& view : bundle.views) {
    const double rms = rms_px(bundle, view) / bundle.noise.corner_px;
    sum += rms * rms * static_cast<double>(view.corners.board_mm.size());
  }
  return sum;
}

/// What the views before each say together; the last is what all say.
std::vector<Part> sums_before(const Bundle& solved) {
  const Index size = num_shared(solved);
  const Part none = {.hessian = MatrixXd::Zero(size, size), .gradient = VectorXd::Zero(size)};
  std::vector<Part> before = {none};
  for (const BundleView& view : solved.views) {
    const SharedInformation one = view_information(solved, view);
    before.push_back({.hessian = before.back().hessian + one.hessian,
                      .gradient = before.back().gradient + one.gradient});
  }
  return before;
}

}  // namespace

std::optional<SecondCamera> find_second_camera(const Bundle& solved) {
  if (solved.are_poses_free || num_shared(solved) == 0) {
    return std::nullopt;
  }
  const std::vector<Part> before = sums_before(solved);
  const Part& all = before.back();
  const double squares = sum_of_squares(solved);
  const double focal_px = solved.lens[0];
  SecondCamera best;
  for (std::size_t i = kLeastViews; i + kLeastViews <= solved.views.size(); ++i) {
    const Part after = {.hessian = all.hessian - before[i].hessian,
                        .gradient = all.gradient - before[i].gradient};
    const VectorXd first = before[i].step();
    const VectorXd second = after.step();
    const double explained =
        -(first.dot(before[i].gradient) + second.dot(after.gradient)) / squares;
    if (explained > best.explained) {
      const bool has_focal = solved.is_free[0];
      best = {.first_view = i,
              .explained = explained,
              .focal_ratio = has_focal ? (focal_px + second[0]) / (focal_px + first[0]) : 1.0};
    }
  }
  return best.explained > kLeastExplained ? std::optional(best) : std::nullopt;
}

}  // namespace glint

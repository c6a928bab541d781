// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/bundle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>

namespace glint {
namespace {

void resize(ViewSystem& system, Eigen::Index rows, bool with_derivatives) {
  system.residual_px.resize(rows);
  if (with_derivatives) {
    system.by_lens.resize(rows, 9);
    system.by_hand_eye.resize(rows, 6);
    system.by_board.resize(rows, 6);
    system.by_error.resize(rows, 6);
  }
}

/// The two rows of a corner in the derivatives of a view.
void set_rows(Eigen::Index row,
              const LensDerivatives& projects,
              const PoseChain::Derivatives& moves,
              ViewSystem& system) {
  system.by_lens.middleRows<2>(row) = projects.by_lens;
  system.by_hand_eye.middleRows<2>(row) = projects.by_point * moves.by_hand_eye;
  system.by_board.middleRows<2>(row) = projects.by_point * moves.by_board;
  system.by_error.middleRows<2>(row) = projects.by_point * moves.by_error;
}

}  // namespace

bool evaluate_view(const Bundle& bundle,
                   const BundleView& view,
                   const LensVector& lens,
                   const ChainIncrement& increment,
                   bool with_derivatives,
                   ViewSystem& system) {
  const PoseChain chain(bundle.mounting, bundle.poses, view.base_from_flange, increment);
  const BoardCorners& corners = view.corners;
  resize(system, static_cast<Eigen::Index>(2 * corners.board_mm.size()), with_derivatives);
  PoseChain::Derivatives moves;
  LensDerivatives projects;
  for (std::size_t i = 0; i < corners.board_mm.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    const Eigen::Vector3d point =
        chain.point_in_camera_mm(corners.board_mm[i], with_derivatives ? &moves : nullptr);
    const auto pixel = project_by_lens(lens, point, with_derivatives ? &projects : nullptr);
    if (!pixel.has_value()) {
      return false;
    }
    system.residual_px.segment<2>(row) = *pixel - corners.picture_px[i];
    if (with_derivatives) {
      set_rows(row, projects, moves, system);
    }
  }
  return true;
}

Bundle without_views(const Bundle& bundle) {
  return {.mounting = bundle.mounting,
          .lens = bundle.lens,
          .is_free = bundle.is_free,
          .lens_prior = bundle.lens_prior,
          .poses = bundle.poses,
          .are_poses_free = bundle.are_poses_free,
          .noise = bundle.noise};
}

int num_shared(const Bundle& bundle) {
  const auto lens = std::count(bundle.is_free.begin(), bundle.is_free.end(), true);
  return static_cast<int>(lens) + (bundle.are_poses_free ? 12 : 0);
}

std::optional<WeightedSystem> weighted_system(const Bundle& bundle, const BundleView& view) {
  ViewSystem system;
  if (!evaluate_view(bundle, view, bundle.lens, {.error = view.error}, true, system)) {
    return std::nullopt;
  }
  Eigen::VectorXd roots(system.residual_px.size());
  for (Eigen::Index i = 0; i < view.weights.size(); ++i) {
    roots.segment<2>(2 * i).setConstant(std::sqrt(view.weights[i]));
  }
  WeightedSystem result;
  result.residual_px = roots.cwiseProduct(system.residual_px);
  result.by_error = roots.asDiagonal() * system.by_error;
  result.by_shared.resize(roots.size(), num_shared(bundle));
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < kLensSize; ++i) {
    if (bundle.is_free[i]) {
      result.by_shared.col(column++) =
          roots.cwiseProduct(system.by_lens.col(static_cast<Eigen::Index>(i)));
    }
  }
  if (bundle.are_poses_free) {
    result.by_shared.middleCols<6>(column) = roots.asDiagonal() * system.by_hand_eye;
    result.by_shared.middleCols<6>(column + 6) = roots.asDiagonal() * system.by_board;
  }
  return result;
}

Eigen::MatrixXd patterns_of(const WeightedSystem& system) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(system.by_error);
  return qr.householderQ() * Eigen::MatrixXd::Identity(system.by_error.rows(), 6);
}

void take_patterns(Bundle& bundle) {
  for (BundleView& view : bundle.views) {
    view.patterns.resize(0, 0);
    if (bundle.noise.pattern_px > bundle.noise.corner_px) {
      const auto system = weighted_system(bundle, view);
      view.patterns = system.has_value() ? patterns_of(*system) : Eigen::MatrixXd();
    }
  }
}

void add_lens_prior(const Bundle& bundle, Eigen::MatrixXd& hessian, Eigen::VectorXd& gradient) {
  if (!bundle.lens_prior.has_value()) {
    return;
  }
  Eigen::Index column = 0;
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(kLensSize); ++i) {
    if (bundle.is_free[static_cast<std::size_t>(i)]) {
      const double information = 1.0 / std::pow(bundle.lens_prior->sigma[i], 2);
      hessian(column, column) += information;
      gradient[column] += information * (bundle.lens[i] - bundle.lens_prior->mean[i]);
      ++column;
    }
  }
}

double rms_px(const Bundle& bundle, const BundleView& view) {
  ViewSystem system;
  if (!evaluate_view(bundle, view, bundle.lens, {.error = view.error}, false, system)) {
    return std::numeric_limits<double>::infinity();
  }
  return std::sqrt(2.0 * system.residual_px.squaredNorm() /
                   static_cast<double>(system.residual_px.size()));
}

}  // namespace glint

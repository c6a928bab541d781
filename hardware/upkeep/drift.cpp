// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/upkeep/drift.h"

#include <cmath>

namespace glint {

using Eigen::Isometry3d;
using Eigen::Vector2d;

double rms_of(std::span<const Vector2d> residuals_px) {
  double square = 0.0;
  for (const Vector2d& residual : residuals_px) {
    square += residual.squaredNorm();
  }
  return residuals_px.empty() ? 0.0 : std::sqrt(square / static_cast<double>(residuals_px.size()));
}

std::optional<std::vector<Vector2d>> residuals_at(const LensVector& lens,
                                                  const Isometry3d& camera_from_board,
                                                  const BoardCorners& corners) {
  std::vector<Vector2d> residuals;
  for (std::size_t i = 0; i < corners.board_mm.size(); ++i) {
    const auto pixel = project_by_lens(lens, camera_from_board * corners.board_mm[i], nullptr);
    if (!pixel) {
      return std::nullopt;
    }
    residuals.emplace_back(corners.picture_px[i] - *pixel);
  }
  return residuals;
}

std::optional<std::vector<Vector2d>> residuals_at(const LensVector& lens,
                                                  const Isometry3d& camera_from_board,
                                                  const BoardSymmetry& symmetry,
                                                  const BoardCorners& corners) {
  std::optional<std::vector<Vector2d>> best;
  for (int turn = 0; turn < symmetry.turns; ++turn) {
    auto residuals = residuals_at(lens, camera_from_board * board_turn(symmetry, turn), corners);
    if (residuals && (!best || rms_of(*residuals) < rms_of(*best))) {
      best = std::move(residuals);
    }
  }
  return best;
}

double drift_limit_px(double expected_px, int freedoms) {
  // Quantile 0.999 of chi-square by Wilson and Hilferty's approximation.
  constexpr double kNormalQuantile = 3.0902;
  const double spread = 2.0 / (9.0 * freedoms);
  const double ratio = std::pow(1.0 - spread + kNormalQuantile * std::sqrt(spread), 3);
  return expected_px * std::sqrt(ratio);
}

Isometry3d board_seen(Mounting mounting,
                      const Isometry3d& hand_eye,
                      std::span<const PosePair> pairs) {
  std::vector<Isometry3d> boards;
  for (const PosePair& pair : pairs) {
    boards.push_back(mounting == Mounting::kEyeInHand
                         ? pair.base_from_flange * hand_eye * pair.camera_from_board
                         : pair.base_from_flange.inverse() * hand_eye * pair.camera_from_board);
  }
  return mean_pose(boards);
}

}  // namespace glint

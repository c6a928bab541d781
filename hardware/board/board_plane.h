// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a flat board lies in a picture, without a calibrated camera: a homography and two radial
// terms about the picture's centre. Good enough to find missing corners and the board's outline.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace glint {

/// Takes places on the board to the picture.
class BoardPlane {
 public:
  /// Fitted to points of the board (in any unit) and of the picture. The radial terms are drawn
  /// towards 0 as those of a usual lens: at the picture's corner 0.15 and 0.05 of the radius
  /// (standard deviations). Empty for fewer than 4 points, or points on a line.
  /// @param accuracy_px  standard deviation of picture_px
  static std::optional<BoardPlane> fitted(std::span<const Eigen::Vector2d> board,
                                          std::span<const Eigen::Vector2d> picture_px,
                                          const Eigen::Vector2d& picture_size_px,
                                          double accuracy_px);

  /// Where a place of the board appears; far outside what was fitted this may be anywhere.
  Eigen::Vector2d operator()(const Eigen::Vector2d& board) const;

  /// Root mean square of the distances that the fit leaves.
  double rms_px() const { return rms_px_; }

 private:
  Eigen::Matrix3d homography_ =
      Eigen::Matrix3d::Identity();  ///< board to (picture - centre) / size
  Eigen::Vector2d radial_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d center_px_ = Eigen::Vector2d::Zero();
  double size_px_ = 1.0;
  double rms_px_ = 0.0;
};

}  // namespace glint

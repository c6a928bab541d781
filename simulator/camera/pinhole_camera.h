// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "simulator/camera/distortion.h"

namespace glint {

/// Everything a pinhole camera with Brown-Conrady distortion needs.
struct PinholeIntrinsics {
  int width_px = 0;
  int height_px = 0;
  Eigen::Vector2d focal_px = {0.0, 0.0};      ///< (fx, fy), both > 0
  Eigen::Vector2d center_px = {0.0, 0.0};     ///< principal point (cx, cy)
  std::array<double, 3> radial = {0, 0, 0};   ///< (k1, k2, k3), dimensionless
  std::array<double, 2> tangential = {0, 0};  ///< (p1, p2), dimensionless
};

/// Maps points in the camera frame to pixels and pixels to viewing rays.
///
/// Frame: right-handed, +x right, +y down, +z along the view. Pixels: (0, 0) is the outer corner of
/// the top-left pixel, whose centre is (0.5, 0.5); opencv_from_pixel() converts. Immutable and safe
/// to share between threads.
///
/// Source: D. C. Brown, "Close-range camera calibration", Photogrammetric Engineering 37(8), 1971;
/// order and signs of (p1, p2) as in OpenCV's calib3d.
class PinholeCamera {
 public:
  /// @throws ConfigError naming the key: size or focal length not positive, or a distortion that
  ///         folds the image onto itself before its corner is reached (the radius is named).
  explicit PinholeCamera(const PinholeIntrinsics& intrinsics);

  /// The pixel where a point appears. Empty when the point is not in front of the camera or lies
  /// beyond the radius at which the distortion turns back; it may fall outside the image.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_in_camera_mm) const;

  /// Unit direction, in the camera frame, of the ray through a pixel; inverse of project() to
  /// 1e-9 px by Newton's method. Empty when no valid ray reaches that pixel.
  std::optional<Eigen::Vector3d> ray_through(const Eigen::Vector2d& pixel_px) const;

  const PinholeIntrinsics& intrinsics() const { return intrinsics_; }

 private:
  void check_whole_image() const;
  Eigen::Vector2d normalised(const Eigen::Vector2d& pixel_px) const;
  std::optional<Eigen::Vector2d> undistort(const Eigen::Vector2d& distorted) const;

  PinholeIntrinsics intrinsics_;
  Distortion distortion_;
  bool is_distorted_ = false;
  double max_radius_ = 0.0;  ///< largest undistorted x/z radius on which distortion is monotonic
};

/// OpenCV counts pixel coordinates from the centre of the first pixel, Glint from its outer corner.
inline Eigen::Vector2d opencv_from_pixel(const Eigen::Vector2d& pixel_px) {
  return pixel_px - Eigen::Vector2d(0.5, 0.5);
}

}  // namespace glint

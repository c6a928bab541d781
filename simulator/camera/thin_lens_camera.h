// SPDX-License-Identifier: GPL-3.0-or-later
//
// Depth of field of a thin lens, in closed form and as rays.
#pragma once

#include <limits>
#include <optional>

#include <Eigen/Core>

#include "simulator/camera/pinhole_camera.h"

namespace glint {

/// The pupil of a camera.
struct ThinLens {
  double aperture_mm = 0.0;  ///< diameter of the entrance pupil; 0: a pinhole
  double focus_mm = std::numeric_limits<double>::infinity();  ///< plane z = focus_mm is sharp
};

/// A ray in the camera frame.
struct CameraRay {
  Eigen::Vector3d origin_mm = {0, 0, 0};  ///< on the lens, z = 0
  Eigen::Vector3d direction = {0, 0, 1};  ///< unit
};

/// Diameter on the sensor of the blur of a point at depth_mm: A v |1 / focus - 1 / depth|, with A
/// the pupil's diameter and v the image distance. For a lens of focal length f that is
/// A f / (focus - f) |depth - focus| / depth.
///
/// Source: M. Potmesil, I. Chakravarty, "Synthetic image generation with a lens and aperture camera
/// model", ACM Transactions on Graphics 1(2), 1982.
/// @param focus_mm  may be infinite
/// @param depth_mm  > 0, along the optical axis
double circle_of_confusion_mm(double aperture_mm,
                              double focus_mm,
                              double image_distance_mm,
                              double depth_mm);

/// Depths whose blur is not wider than a limit.
struct DepthOfField {
  double near_mm = 0.0;
  double far_mm = std::numeric_limits<double>::infinity();
};

/// The depths between which circle_of_confusion_mm() is at most blur_mm (> 0).
DepthOfField depth_of_field(double aperture_mm,
                            double focus_mm,
                            double image_distance_mm,
                            double blur_mm);

/// A point of the unit disc for a point of the unit square; keeps areas, so a stratified square
/// gives a stratified disc.
///
/// Source: P. Shirley, K. Chiu, "A low distortion map between disk and square", Journal of Graphics
/// Tools 2(3), 1997.
Eigen::Vector2d disc_from_square(const Eigen::Vector2d& square);

/// A pinhole camera with a pupil: rays through one pixel start anywhere on the lens and meet in the
/// plane in focus. Distortion belongs to the ray through the middle of the lens. Immutable.
class ThinLensCamera {
 public:
  /// @throws ConfigError when the aperture is negative or the focus not > 0
  ThinLensCamera(PinholeCamera pinhole, const ThinLens& lens);

  /// @param pixel_px     where on the picture, as PinholeCamera counts
  /// @param lens_sample  in [0, 1)^2, spread evenly over the pupil
  /// Empty when no valid ray reaches that pixel. A pinhole gives the pinhole camera's ray, bit for
  /// bit.
  std::optional<CameraRay> sample(const Eigen::Vector2d& pixel_px,
                                  const Eigen::Vector2d& lens_sample) const;

  const ThinLens& lens() const { return lens_; }

 private:
  PinholeCamera pinhole_;
  ThinLens lens_;
};

}  // namespace glint

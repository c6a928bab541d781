// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures as a camera without distortion would have taken them from the same place.
#pragma once

#include "core/image/image.h"
#include "core/thread_pool.h"
#include "simulator/camera/pinhole_camera.h"

namespace glint {

/// Where each pixel of the picture without distortion lies in the real one. The distortion maps
/// rays to pixels in closed form, so that no equation has to be solved and the map is exact.
class Undistortion {
 public:
  /// @throws ConfigError as PinholeCamera
  Undistortion(const PinholeIntrinsics& camera, ThreadPool& pool);

  /// Between pixels by Catmull-Rom's cubic (R. Keys, 1981, a = -1/2), which keeps ramps and
  /// parabolas exactly; values beyond the border are those of the border's nearest pixel. 0 where
  /// the real picture shows nothing. Not clamped: beside edges values may lie a little beyond their
  /// neighbours'.
  /// @param picture  of the camera's size
  ImageF operator()(const ImageF& picture, ThreadPool& pool) const;

  /// Share of the pixels that the real picture does not show.
  double outside_share() const { return outside_share_; }

 private:
  int width_px_ = 0;
  int height_px_ = 0;
  Image<double> x_px_;  ///< in the real picture; NaN: outside
  Image<double> y_px_;
  double outside_share_ = 0.0;
};

}  // namespace glint

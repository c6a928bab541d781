// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/thin_lens_camera.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/units.h"

namespace glint {

using Eigen::Vector2d;
using Eigen::Vector3d;

double circle_of_confusion_mm(double aperture_mm,
                              double focus_mm,
                              double image_distance_mm,
                              double depth_mm) {
  return aperture_mm * image_distance_mm * std::abs(1.0 / focus_mm - 1.0 / depth_mm);
}

DepthOfField depth_of_field(double aperture_mm,
                            double focus_mm,
                            double image_distance_mm,
                            double blur_mm) {
  if (!(aperture_mm > 0.0)) {
    return {};
  }
  const double spread = blur_mm / (aperture_mm * image_distance_mm);  // in 1 / depth
  const double far_end = 1.0 / focus_mm - spread;
  DepthOfField depth;
  depth.near_mm = 1.0 / (1.0 / focus_mm + spread);
  if (far_end > 0.0) {
    depth.far_mm = 1.0 / far_end;
  }
  return depth;
}

Vector2d disc_from_square(const Vector2d& square) {
  const double x = 2.0 * square.x() - 1.0;
  const double y = 2.0 * square.y() - 1.0;
  if (x == 0.0 && y == 0.0) {
    return {0.0, 0.0};
  }
  if (std::abs(x) > std::abs(y)) {
    const double angle = 0.25 * kPi * y / x;
    return {x * std::cos(angle), x * std::sin(angle)};
  }
  const double angle = 0.25 * kPi * x / y;
  return {y * std::sin(angle), y * std::cos(angle)};
}

ThinLensCamera::ThinLensCamera(PinholeCamera pinhole, const ThinLens& lens)
    : pinhole_(std::move(pinhole)), lens_(lens) {
  if (!(lens_.aperture_mm >= 0.0) || !std::isfinite(lens_.aperture_mm)) {
    throw ConfigError("lens.f_number",
                      fmt::format("gives an aperture of {} mm, must be >= 0", lens_.aperture_mm));
  }
  if (!(lens_.focus_mm > 0.0)) {
    throw ConfigError("lens.focus_mm", fmt::format("is {}, must be > 0", lens_.focus_mm));
  }
}

std::optional<CameraRay> ThinLensCamera::sample(const Vector2d& pixel_px,
                                                const Vector2d& lens_sample) const {
  const std::optional<Vector3d> central = pinhole_.ray_through(pixel_px);
  if (!central) {
    return std::nullopt;
  }
  if (lens_.aperture_mm == 0.0) {
    return CameraRay{.direction = *central};
  }
  const Vector2d start = 0.5 * lens_.aperture_mm * disc_from_square(lens_sample);
  const Vector3d origin(start.x(), start.y(), 0.0);
  // (focal point - origin) / focus, which also holds for a focus at infinity.
  const Vector3d towards = *central / central->z() - origin / lens_.focus_mm;
  return CameraRay{.origin_mm = origin, .direction = towards.normalized()};
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/lens_settings.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "simulator/camera/thin_lens_camera.h"

namespace glint {
namespace {

/// Image distance when focused at infinity, or as measured: the one intrinsics_of() works with.
double plain_image_distance_mm(const CameraSettings& camera) {
  return intrinsics_of(camera).focal_px.x() * camera.pixel_mm;
}

bool is_focal_length_given(const CameraSettings& camera) {
  return camera.focal_x_px <= 0.0 && camera.focal_mm > 0.0;
}

double image_distance_mm(const CameraSettings& camera, const LensSettings& lens) {
  if (!is_focal_length_given(camera) || lens.focus_mm <= 0.0) {
    return plain_image_distance_mm(camera);
  }
  if (!(lens.focus_mm > camera.focal_mm)) {
    throw ConfigError("lens.focus_mm",
                      fmt::format("is {:g}, must be beyond the focal length of {:g} mm; 0 = "
                                  "infinity",
                                  lens.focus_mm,
                                  camera.focal_mm));
  }
  return lens.focus_mm * camera.focal_mm / (lens.focus_mm - camera.focal_mm);
}

}  // namespace

void visit_keys(KeyVisitor& keys, LensSettings& s) {
  keys.number("focus_mm",
              s.focus_mm,
              Range::between(0, 1e6),
              "distance from the lens to the plane in focus; 0 = infinity");
  keys.number("f_number",
              s.f_number,
              Range::between(0, 256),
              "focal length over diameter of the entrance pupil; 0 = a pinhole, all is sharp");
  keys.require(!(s.f_number > 0.0) || s.focus_mm > 0.0,
               "f_number",
               "needs focus_mm, the distance at which the picture is sharp");
}

LensGeometry lens_geometry(const CameraSettings& camera, const LensSettings& lens) {
  LensGeometry g;
  g.image_distance_mm = image_distance_mm(camera, lens);
  const bool is_focused = lens.focus_mm > 0.0;
  g.focus_mm = is_focused ? lens.focus_mm : std::numeric_limits<double>::infinity();
  g.focal_mm = 1.0 / (1.0 / g.image_distance_mm + 1.0 / g.focus_mm);
  g.aperture_mm = lens.f_number > 0.0 ? g.focal_mm / lens.f_number : 0.0;
  const PinholeIntrinsics in = intrinsics_of(camera, lens);
  const Eigen::Vector2d size_px(in.width_px, in.height_px);
  g.object_pixel_mm = camera.working_distance_mm / in.focal_px.x();
  g.sensor_mm = size_px * camera.pixel_mm;
  g.field_of_view_mm = camera.working_distance_mm * size_px.cwiseQuotient(in.focal_px);
  for (int axis = 0; axis < 2; ++axis) {
    g.view_angle_rad[axis] = std::atan(in.center_px[axis] / in.focal_px[axis]) +
                             std::atan((size_px[axis] - in.center_px[axis]) / in.focal_px[axis]);
  }
  const DepthOfField depth =
      depth_of_field(g.aperture_mm, g.focus_mm, g.image_distance_mm, camera.pixel_mm);
  g.near_mm = depth.near_mm;
  g.far_mm = depth.far_mm;
  return g;
}

PinholeIntrinsics intrinsics_of(const CameraSettings& camera, const LensSettings& lens) {
  PinholeIntrinsics intrinsics = intrinsics_of(camera);
  if (is_focal_length_given(camera) && lens.focus_mm > 0.0) {
    const double focal_px = image_distance_mm(camera, lens) / camera.pixel_mm;
    intrinsics.focal_px = {focal_px, camera.focal_y_px > 0.0 ? camera.focal_y_px : focal_px};
  }
  return intrinsics;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/camera_settings.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

namespace glint {
namespace {

using Eigen::Vector3d;

Vector3d to_vector(const std::vector<double>& values) {
  return {values[0], values[1], values[2]};
}

}  // namespace

void visit_keys(KeyVisitor& keys, CameraSettings& s) {
  keys.integer("width_px", s.width_px, Range::between(1, 32768), "image width");
  keys.integer("height_px", s.height_px, Range::between(1, 32768), "image height");
  keys.number(
      "pixel_um", s.pixel_mm, Range{.min = 0.1, .max = 100}, "size of a pixel on the sensor");
  keys.number("focal_mm",
              s.focal_mm,
              Range::between(0, 5000),
              "focal length; 0 = from object_pixel_mm and working_distance_mm");
  keys.number("object_pixel_mm",
              s.object_pixel_mm,
              Range::between(0, 100),
              "size of a pixel on the part at the working distance; 0 = from focal_mm");
  keys.number(
      "working_distance_mm",
      s.working_distance_mm,
      Range{.min = 1, .max = 1e5},
      "from the pinhole to the scene's origin; places the camera when no viewpoint is given");
  keys.number("focal_x_px",
              s.focal_x_px,
              Range::at_least(0),
              "calibrated focal length along x; 0 = from the data sheet");
  keys.number("focal_y_px",
              s.focal_y_px,
              Range::at_least(0),
              "calibrated focal length along y; 0 = as along x");
  keys.number("center_x_px",
              s.center_x_px,
              Range::at_least(0),
              "principal point from the left edge of the image; 0 = the middle");
  keys.number("center_y_px",
              s.center_y_px,
              Range::at_least(0),
              "principal point from the upper edge of the image; 0 = the middle");
  keys.number("k1", s.k1, Range{}, "radial distortion, second order (OpenCV's k1)");
  keys.number("k2", s.k2, Range{}, "radial distortion, fourth order");
  keys.number("k3", s.k3, Range{}, "radial distortion, sixth order");
  keys.number("p1", s.p1, Range{}, "tangential distortion (OpenCV's p1)");
  keys.number("p2", s.p2, Range{}, "tangential distortion (OpenCV's p2)");
  if (s.focal_mm > 0.0 && !keys.is_given("object_pixel_mm")) {
    s.object_pixel_mm = 0.0;
  }
  keys.require((s.focal_mm > 0.0) != (s.object_pixel_mm > 0.0),
               "object_pixel_mm",
               "and focal_mm say the same thing: exactly one of them must be > 0");
}

void visit_keys(KeyVisitor& keys, Viewpoint& v) {
  const Count three = {.min = 3, .max = 3};
  keys.numbers("position_mm", v.position_mm, three, Range{}, "the pinhole, in the scene's frame");
  keys.numbers("direction", v.direction, three, Range{}, "of the view, any length");
  keys.numbers("up", v.up, three, Range{}, "towards the top of the image");
  const Vector3d cross = to_vector(v.direction).cross(to_vector(v.up));
  keys.require(cross.norm() > 1e-9 * to_vector(v.direction).norm() * to_vector(v.up).norm() &&
                   to_vector(v.direction).norm() > 0 && to_vector(v.up).norm() > 0,
               "up",
               "must not be zero or parallel to direction");
}

PinholeIntrinsics intrinsics_of(const CameraSettings& s) {
  double focal_px = s.focal_x_px;
  if (focal_px <= 0.0) {
    focal_px =
        s.focal_mm > 0.0 ? s.focal_mm / s.pixel_mm : s.working_distance_mm / s.object_pixel_mm;
  }
  return {.width_px = s.width_px,
          .height_px = s.height_px,
          .focal_px = {focal_px, s.focal_y_px > 0.0 ? s.focal_y_px : focal_px},
          .center_px = {s.center_x_px > 0.0 ? s.center_x_px : 0.5 * s.width_px,
                        s.center_y_px > 0.0 ? s.center_y_px : 0.5 * s.height_px},
          .radial = {s.k1, s.k2, s.k3},
          .tangential = {s.p1, s.p2}};
}

Viewpoint default_viewpoint(const CameraSettings& settings) {
  return {.position_mm = {0.0, 0.0, settings.working_distance_mm}};
}

RigidTransform camera_from_world(const Viewpoint& viewpoint) {
  const Vector3d forward = to_vector(viewpoint.direction).normalized();
  const Vector3d right = forward.cross(to_vector(viewpoint.up));
  if (!(right.norm() > 1e-12)) {
    throw ConfigError("viewpoint.up", "must not be zero or parallel to direction");
  }
  const Vector3d x = right.normalized();
  const Vector3d y = forward.cross(x);
  RigidTransform pose;
  pose.rotation.row(0) = x.transpose();
  pose.rotation.row(1) = y.transpose();
  pose.rotation.row(2) = forward.transpose();
  pose.translation_mm = -(pose.rotation * to_vector(viewpoint.position_mm));
  return pose;
}

}  // namespace glint

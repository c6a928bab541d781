// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/reference/reference_scene.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/error.h"
#include "studies/definition/scene_notes.h"

namespace glint::stability {
namespace {

using Eigen::Vector3d;
using PartShape = PartSettings::Shape;

void require(bool is_met, const char* key, const char* what) {
  if (!is_met) {
    throw ConfigError(key, std::string(what) + "; the reference of glint stability has none of it");
  }
}

Vector3d vector3(const std::vector<double>& v) {
  return {v.at(0), v.at(1), v.at(2)};
}

double bend_of(double radius_mm, const char* key) {
  require(!(radius_mm < 0.0), key, "is concave");
  return radius_mm == 0.0 || std::isinf(radius_mm) ? 0.0 : 1.0 / radius_mm;
}

/// Dents and bumps at their listed places.
void add_dents(const NamedGroup& named, ReferencePart& part) {
  const auto& [name, group] = named;
  const bool is_bump = group.type == DefectType::kBump;
  require(is_bump || group.type == DefectType::kDent, "defects", "is neither dent nor bump");
  require(group.count.max == 0.0 && group.at_mm.empty(), "defects", "has drawn places");
  for (std::size_t i = 0; i < group.x_mm.size(); ++i) {
    part.dents.push_back({.label = name + "_" + std::to_string(i + 1),
                          .x_mm = group.x_mm[i],
                          .y_mm = group.y_mm.at(i),
                          .height_mm = (is_bump ? 1.0 : -1.0) * group.height_mm.min,
                          .sigma_mm = group.diameter_mm.min / 4.0});
  }
}

/// The origin is the middle of the bounding box.
void set_slab(const PartSettings& s, bool is_curved, ReferencePart& part) {
  if (is_curved) {
    part.bend_along = bend_of(s.radius_along_mm, "part.radius_along_mm");
    part.bend_across = bend_of(s.radius_across_mm, "part.radius_across_mm");
  }
  const double sag_mm =
      (s.length_mm * s.length_mm * part.bend_along + s.width_mm * s.width_mm * part.bend_across) /
      8.0;
  part.half_mm = {0.5 * s.length_mm, 0.5 * s.width_mm};
  part.centre_z_mm = 0.5 * (sag_mm + s.thickness_mm);
}

ReferencePart part_of(const SceneSettings& scene) {
  const PartSettings& s = scene.part;
  ReferencePart part;
  part.position_mm = vector3(s.position_mm);
  require(vector3(s.rotation_rad).isZero(), "part.rotation_deg", "turns the part");
  if (s.shape == PartShape::kStrip || s.shape == PartShape::kPlate) {
    set_slab(s, s.shape == PartShape::kStrip, part);
  } else if (s.shape == PartShape::kSphereCap) {
    part.shape = ReferencePart::Shape::kSphere;
    part.radius_mm = s.radius_mm;
    const double height_mm = std::min(s.height_mm, 2.0 * s.radius_mm);
    part.centre_z_mm = 0.5 * height_mm - s.radius_mm;
    part.base_z_mm = -0.5 * height_mm;
  } else {
    require(
        s.shape == PartShape::kCylinder, "part.shape", "is not strip, plate, sphere or cylinder");
    part.shape = ReferencePart::Shape::kCylinder;
    part.radius_mm = s.radius_mm;
    part.half_mm = {0.5 * s.length_mm, s.radius_mm};
  }
  for (const NamedGroup& group : scene.defects) {
    add_dents(group, part);
  }
  return part;
}

ReferenceCamera camera_of(const SceneSettings& scene) {
  const CameraSettings& s = scene.camera;
  require(s.k1 == 0.0 && s.k2 == 0.0 && s.k3 == 0.0 && s.p1 == 0.0 && s.p2 == 0.0,
          "camera",
          "has distortion");
  require(s.focal_mm == 0.0 && s.focal_x_px == 0.0 && s.center_x_px == 0.0 && s.center_y_px == 0.0,
          "camera",
          "is not given by object_pixel_mm");
  ReferenceCamera camera{.width_px = s.width_px, .height_px = s.height_px};
  camera.focal_px.setConstant(s.working_distance_mm / s.object_pixel_mm);
  camera.center_px = {0.5 * s.width_px, 0.5 * s.height_px};
  const Viewpoint& view = scene.viewpoint();
  camera.origin_mm = vector3(view.position_mm);
  const Vector3d forward = vector3(view.direction).normalized();
  const Vector3d right = forward.cross(vector3(view.up)).normalized();
  camera.axes = {right, forward.cross(right), forward};
  if (scene.lens.f_number > 0.0) {
    // Image distance v = focal_px * pixel_mm, 1 / focal = 1 / focus + 1 / v.
    const double image_mm = camera.focal_px.x() * s.pixel_mm;
    require(scene.lens.focus_mm > 0.0, "lens.focus_mm", "is at infinity");
    camera.focus_mm = scene.lens.focus_mm;
    camera.aperture_mm = 1.0 / (1.0 / camera.focus_mm + 1.0 / image_mm) / scene.lens.f_number;
  }
  return camera;
}

ReferenceWall wall_of(const SceneSettings& scene) {
  const TunnelSettings& s = scene.tunnel;
  const bool is_round = s.shape == TunnelSettings::Shape::kSemicylinder;
  require(
      !scan_line(scene).empty() && light_lines(scene).size() == 1, "lighting", "is not one tunnel");
  require(is_round || s.shape == TunnelSettings::Shape::kEllipse,
          "lighting.tunnel.shape",
          "is not semicylinder or ellipse");
  require(s.dark_reflectance == 0.0, "lighting.tunnel.dark_reflectance", "returns light");
  require(s.orientation_rad == 0.0, "lighting.tunnel.orientation_deg", "turns the stripes");
  require(s.led_ripple == 0.0 && s.end_falloff == 0.0 && !s.cosine_law,
          "lighting.tunnel",
          "is unevenly bright");
  return {
      .half_width_mm = is_round ? s.radius_mm : s.half_width_mm,
      .height_mm = is_round ? s.radius_mm : s.height_mm,
      .base_mm = s.base_mm,
      .length_mm = s.length_mm,
      .slot_mm = s.slot_mm,
      .blocks_view = s.blocks_view,
      .period_mm = s.period_mm,
      .duty = s.duty,
      .offset_mm = s.offset_mm,
      .step_mm = scene.scan.step_mm > 0.0 ? scene.scan.step_mm : s.period_mm / scene.scan.positions,
      .positions = scene.scan.positions};
}

}  // namespace

ReferenceScene reference_scene(const SceneSettings& scene) {
  require(scene.sensor.read_noise_e == 0.0, "sensor.read_noise_e", "is noise");
  require(scene.sensor.dark_e == 0.0, "sensor.dark_e", "is a dark signal");
  require(scene.expose_to == 0.0, "sensor.expose_to", "chooses the exposure");
  return {.part = part_of(scene),
          .camera = camera_of(scene),
          .wall = wall_of(scene),
          .sensor = scene.sensor,
          .metrics = scene.metrics};
}

}  // namespace glint::stability

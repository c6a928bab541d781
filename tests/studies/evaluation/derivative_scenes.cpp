// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/studies/evaluation/derivative_scenes.h"

#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "core/rng.h"

namespace glint {
namespace {

using Shape = TunnelSettings::Shape;

double away_from_quarters(Rng& rng) {
  const double quarters = std::floor(rng.uniform(3.0, 7.999));
  return 0.25 * (quarters + rng.uniform(0.15, 0.85));
}

}  // namespace

std::vector<SceneSettings> derivative_parts() {
  SceneSettings base;
  base.render.method = RenderSettings::Method::kClosed;
  base.sensor.bits = 0;
  base.camera = {
      .width_px = 120, .height_px = 48, .object_pixel_mm = 0.4, .working_distance_mm = 400.0};
  base.part = {.shape = PartSettings::Shape::kStrip,
               .length_mm = 90.0,
               .width_mm = 60.0,
               .radius_along_mm = 400.0,
               .radius_across_mm = 120.0};
  base.viewpoint().position_mm = {0.0, 0.0, 400.0};
  DefectGroup dents;
  dents.x_mm = {-9.0, 12.0};
  dents.y_mm = {3.0, -2.0};
  dents.height_mm = 1e-2;
  dents.diameter_mm = 5.0;
  base.defects.emplace_back("dent", dents);
  std::vector<SceneSettings> all = {base, base, base, base};
  all[1].part.radius_along_mm = 150.0;
  all[1].part.radius_across_mm = 200.0;
  all[1].defects[0].second.diameter_mm = 1.8;  // so small that its pixels are refined
  all[2].part.length_mm = 40.0;
  all[2].part.width_mm = 15.0;
  all[2].metrics.erosion_px = 9;
  all[3].metrics.erosion_px = 9;
  all[3].part = {.shape = PartSettings::Shape::kSphereCap, .radius_mm = 60.0, .height_mm = 3.0};
  return all;
}

SceneSettings derivative_scene(const std::vector<SceneSettings>& parts, std::uint64_t index) {
  Rng rng(97, Stream::kTest, index);
  SceneSettings scene = parts[index % parts.size()];
  TunnelSettings& t = scene.tunnel;
  t.shape = static_cast<Shape>(index / parts.size() % 5);
  t.base_mm = rng.uniform(-10.0, 10.0);
  t.radius_mm = rng.uniform(60.0, 250.0);
  t.half_width_mm = rng.uniform(60.0, 250.0);
  t.height_mm = rng.uniform(60.0, 250.0);
  t.exponent = rng.uniform(1.5, 5.0);
  t.distance_mm = rng.uniform(40.0, 120.0);
  t.opening_rad = rng.uniform(0.3, 1.6);
  t.panel_height_mm = rng.uniform(80.0, 300.0);
  for (double& control : t.control_mm) {
    control = rng.uniform(70.0, 250.0);
  }
  t.length_mm = 3000.0;
  t.slot_mm = rng.uniform() < 0.3 ? 0.0 : rng.uniform(5.0, 40.0);
  t.blocks_view = false;
  t.period_mm = rng.uniform(4.0, 20.0);
  scene.scan.positions = 12 + static_cast<int>(rng.uniform(0.0, 36.999));
  const double whole = std::round(rng.uniform(0.25, 0.75) * scene.scan.positions);
  t.duty = rng.uniform() < 0.5 ? whole / scene.scan.positions : rng.uniform(0.25, 0.75);
  t.offset_mm = rng.uniform(0.0, 20.0);
  t.dark_reflectance = rng.uniform() < 0.4 ? rng.uniform(0.1, 0.6) : 0.0;
  // A quarter of the scenes do not clip: their mean is.
  scene.sensor.gain = rng.uniform() < 0.25 ? rng.uniform(0.6, 0.95) : rng.uniform(1.05, 3.0);
  scene.sensor.blur_px = away_from_quarters(rng);
  return scene;
}

std::vector<std::string> keys_offered(const SceneSettings& scene) {
  std::vector<std::string> keys;
  const std::string tunnel = "lighting.tunnel.";
  switch (scene.tunnel.shape) {
    case Shape::kFlat:
      keys = {"distance_mm", "opening_deg", "panel_height_mm"};
      break;
    case Shape::kFree:
      for (std::size_t i = 0; i < scene.tunnel.control_mm.size(); ++i) {
        keys.push_back(fmt::format("control_mm.{}", i));
      }
      break;
    case Shape::kSemicylinder:
      keys = {"radius_mm"};
      break;
    case Shape::kEllipse:
      keys = {"half_width_mm", "height_mm"};
      break;
    case Shape::kSuperellipse:
      keys = {"half_width_mm", "height_mm", "exponent"};
  }
  for (const char* key : {"base_mm", "period_mm", "duty", "offset_mm"}) {
    keys.emplace_back(key);
  }
  if (scene.tunnel.slot_mm > 0.0) {
    keys.emplace_back("slot_mm");
  }
  for (std::string& key : keys) {
    key = tunnel + key;
  }
  for (const char* key : {"sensor.gain", "sensor.exposure", "sensor.blur_px"}) {
    keys.emplace_back(key);
  }
  // The direction of a view has two degrees of freedom: its own length changes nothing.
  for (const char* key :
       {"position_mm.0", "position_mm.1", "position_mm.2", "direction.0", "direction.1", "up.0"}) {
    keys.push_back(std::string("viewpoint.0.") + key);
  }
  return keys;
}

bool is_of_pose(const std::string& path) {
  return path.starts_with("viewpoint.");
}

SceneSettings with_value(const SceneSettings& scene, const std::string& path, double change) {
  ConfigNode root = write_scene(scene);
  set_path(root, path, ConfigNode::from_number(root.at_path(path)->number + change));
  std::vector<Problem> errors;
  SceneSettings changed = read_scene(root, errors);
  if (!errors.empty()) {
    throw ConfigError(errors);
  }
  return changed;
}

double step_of(const SceneSettings& scene, const std::string& path) {
  const TunnelSettings& t = scene.tunnel;
  constexpr double kPartOfRipple = 2e-3;
  const double move_mm = kPartOfRipple * t.period_mm / scene.scan.positions;
  if (path.ends_with("duty")) {
    return kPartOfRipple / scene.scan.positions;
  }
  if (path.ends_with("exponent")) {
    return 0.02 * move_mm;
  }
  if (path.ends_with("opening_deg")) {
    return 0.3 * move_mm;
  }
  if (path.ends_with("period_mm")) {
    return 0.1 * move_mm;  // places lie many periods away
  }
  if (path.starts_with("sensor.")) {
    return 1e-4;
  }
  if (is_of_pose(path) && !path.starts_with("viewpoint.0.position")) {
    return 1e-3 * move_mm;
  }
  return move_mm;
}

}  // namespace glint

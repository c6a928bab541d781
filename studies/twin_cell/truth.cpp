// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/twin_cell/truth.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/config/keys.h"
#include "core/config/toml.h"
#include "core/rng.h"

namespace glint {

void visit_keys(KeyVisitor& keys, TruthSettings& settings) {
  constexpr Count kThree = {.min = 3, .max = 3};
  keys.boolean("eye_to_hand",
               settings.is_eye_to_hand,
               "the camera stands in the robot's base and the flange holds the scene");
  keys.numbers("camera_position_mm",
               settings.camera_position_mm,
               kThree,
               Range::between(-5000, 5000),
               "where the camera sits on the flange, or with eye_to_hand in the base");
  keys.numbers("camera_rotation_deg",
               settings.camera_rotation_rad,
               kThree,
               Range::between(-360, 360),
               "how it is turned: axis times angle");
  keys.numbers(
      "scene_position_mm",
      settings.scene_position_mm,
      kThree,
      Range::between(-5000, 5000),
      "where the scene's origin lies in the robot's base, or with eye_to_hand on the flange");
  keys.numbers("scene_rotation_deg",
               settings.scene_rotation_rad,
               kThree,
               Range::between(-360, 360),
               "how the scene is turned: axis times angle");
  keys.numbers("placement_mm",
               settings.placement_mm,
               kThree,
               Range::between(0, 100),
               "how far it lies elsewhere each time that it is put down, each of its axes");
  keys.numbers("placement_deg",
               settings.placement_rad,
               kThree,
               Range::between(0, 45),
               "how far it is turned then, about each of its axes");
  keys.number("exposure_us",
              settings.exposure_s,
              Range::positive(),
              "exposure of the camera at which the truth's own sensor.exposure holds");
  keys.number("position_noise_mm",
              settings.position_noise_mm,
              Range::between(0, 100),
              "how far the flange is from where the robot says, each axis");
  keys.number("rotation_noise_deg",
              settings.rotation_noise_rad,
              Range::between(0, 45),
              "how far it is turned from that, each axis");
  keys.number("joint_noise_deg",
              settings.joint_noise_rad,
              Range::between(0, 5),
              "how far each joint is from where the robot says; takes the flange along");
  keys.integer("seed", settings.seed, Range::at_least(0), "of these errors and the sensor's noise");
}

RigidTransform transform_of(const Eigen::Isometry3d& pose) {
  return {.rotation = pose.linear(), .translation_mm = pose.translation()};
}

RigidTransform pose_of(const std::vector<double>& position_mm,
                       const std::vector<double>& rotation_rad) {
  const Eigen::Vector3d vector(rotation_rad.at(0), rotation_rad.at(1), rotation_rad.at(2));
  RigidTransform pose;
  pose.translation_mm = {position_mm.at(0), position_mm.at(1), position_mm.at(2)};
  if (vector.norm() > 0.0) {
    pose.rotation = Eigen::AngleAxisd(vector.norm(), vector.normalized()).toRotationMatrix();
  }
  return pose;
}

RigidTransform Truth::carrier_from_camera() const {
  return pose_of(settings.camera_position_mm, settings.camera_rotation_rad);
}

RigidTransform Truth::carrier_from_scene(int placement) const {
  Rng random(static_cast<std::uint64_t>(settings.seed),
             Stream::kRobotErrors,
             static_cast<std::uint64_t>(placement));
  std::vector<double> off_mm = settings.placement_mm;
  std::vector<double> off_rad = settings.placement_rad;
  for (std::size_t i = 0; i < 3; ++i) {
    off_mm[i] *= random.normal();
    off_rad[i] *= random.normal();
  }
  return pose_of(settings.scene_position_mm, settings.scene_rotation_rad) *
         pose_of(off_mm, off_rad);
}

RigidTransform Truth::scene_from_camera(const RigidTransform& base_from_flange,
                                        const RigidTransform& flange_error,
                                        int placement) const {
  const RigidTransform lies = carrier_from_scene(placement);
  if (settings.is_eye_to_hand) {
    return inverse(base_from_flange * flange_error * lies) * carrier_from_camera();
  }
  return inverse(lies) * base_from_flange * flange_error * carrier_from_camera();
}

RigidTransform Truth::base_from_flange(const RigidTransform& scene_from_camera) const {
  const RigidTransform from_scene_to_camera =
      carrier_from_scene() * scene_from_camera * inverse(carrier_from_camera());
  return settings.is_eye_to_hand ? inverse(from_scene_to_camera) : from_scene_to_camera;
}

Truth read_truth(const std::filesystem::path& file) {
  const ConfigNode root = load_toml(file);
  std::vector<Problem> errors;
  Truth truth;
  truth.scene = read_scene(root, errors);
  KeyReader reader(root.find("truth"), "truth", errors);
  visit_keys(reader, truth.settings);
  reader.report_unknown();
  for (std::size_t i = 0; i < root.names.size(); ++i) {
    const std::string& name = root.names[i];
    const std::vector<std::string>& known = scene_tables();
    if (name != "truth" && name != "schema" && name != "title" &&
        std::ranges::find(known, name) == known.end()) {
      errors.push_back({.kind = Problem::Kind::kUnknownKey,
                        .place = root.items[i].place,
                        .key = name,
                        .text = "is no table of a scene, and not [truth]"});
    }
  }
  throw_if_any(errors);
  return truth;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/pose_numbers.h"

#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/units.h"
#include "hardware/robot/ur_settings.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::vector<double> six_of(const Json& json) {
  const bool is_six = json.is_array() && json.size() == 6 &&
                      std::all_of(json.begin(), json.end(), [](const Json& number) {
                        return number.is_number() && std::isfinite(number.get<double>());
                      });
  if (!is_six) {
    throw ConfigError("must be six numbers");
  }
  return json.get<std::vector<double>>();
}

}  // namespace

Json six_numbers(const Eigen::Isometry3d& pose) {
  const Eigen::AngleAxisd turn(pose.linear());
  const Eigen::Vector3d rotation = turn.angle() * turn.axis();
  const Eigen::Vector3d position = pose.translation();
  return {position.x(), position.y(), position.z(), rotation.x(), rotation.y(), rotation.z()};
}

Json joints_deg(const JointVector& joints_rad) {
  Json json = Json::array();
  for (int i = 0; i < 6; ++i) {
    json.push_back(joints_rad[i] * kDegPerRad);
  }
  return json;
}

Eigen::Isometry3d pose_of_numbers(const Json& six) {
  return pose_of_six(six_of(six));
}

Eigen::Isometry3d pose_of(const nlohmann::ordered_json& pose) {
  nlohmann::ordered_json six = pose.at("translation_mm");
  for (const nlohmann::ordered_json& number : pose.at("rotation_vector_rad")) {
    six.push_back(number);
  }
  return pose_of_numbers(six);
}

JointVector joints_of_deg(const Json& six) {
  const std::vector<double> numbers = six_of(six);
  return Eigen::Map<const JointVector>(numbers.data()) / kDegPerRad;
}

}  // namespace glint

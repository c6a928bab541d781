// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/controller_outputs.h"

#include <string>

#include "hardware/robot/twin_proof.h"
#include "hardware/twin/robot/twin_controller.h"

namespace glint {
namespace {

constexpr double kMPerMm = 1e-3;

std::array<double, 6> array_of(const JointVector& vector) {
  std::array<double, 6> values = {};
  Eigen::Map<JointVector>(values.data()) = vector;
  return values;
}

/// Metres and a rotation vector.
std::array<double, 6> pose_array(const Eigen::Isometry3d& pose) {
  JointVector six = pose_difference(pose, Eigen::Isometry3d::Identity());
  six.head<3>() *= kMPerMm;
  return array_of(six);
}

/// What no twin changes.
RtdeValue constant_value_of(std::string_view name) {
  if (name == "speed_scaling" || name == "target_speed_fraction") {
    return 1.0;
  }
  if (name == "joint_mode") {
    constexpr std::int32_t kJointRunning = 253;
    std::array<std::int32_t, 6> modes = {};
    modes.fill(kJointRunning);
    return modes;
  }
  if (name == "joint_temperatures") {
    std::array<double, 6> degrees = {};
    degrees.fill(30.0);
    return degrees;
  }
  if (name == "actual_execution_time") {
    return 0.5;
  }
  if (name == "actual_digital_input_bits") {
    return std::uint64_t{0};
  }
  return std::uint32_t{0};  // output_bit_registers
}

}  // namespace

std::size_t register_number(std::string_view name) {
  const std::string_view digits = name.substr(name.rfind('_') + 1);
  return static_cast<std::size_t>(std::stoi(std::string(digits)));
}

std::optional<RtdeType> ControllerOutputs::type_of(std::string_view name) const {
  if (name == kTwinTokenOutput) {
    return twin_.settings_.token != 0 ? std::optional(RtdeType::kUint64) : std::nullopt;
  }
  const bool is_newer = name == "tcp_offset" || name == "payload" || name == "payload_cog";
  return is_newer && !twin_.settings_.has_newer_outputs ? std::nullopt : output_type(name);
}

std::array<double, 6> ControllerOutputs::tool_speed() const {
  const bool is_moving = twin_.motion_.speed_rad_s().cwiseAbs().maxCoeff() > 0.0;
  const Eigen::Isometry3d flange = twin_.settings_.arm.forward(twin_.motion_.joints_rad());
  JointVector speed =
      twin_.settings_.arm.jacobian(twin_.motion_.joints_rad()) * twin_.motion_.speed_rad_s();
  const Eigen::Vector3d lever_mm = flange.linear() * twin_.tcp().translation();
  speed.head<3>() += speed.tail<3>().cross(lever_mm);
  speed.head<3>() *= kMPerMm * (twin_.is_overspeed_ && is_moving ? 20.0 : 1.0);
  return array_of(speed);
}

std::optional<RtdeValue> ControllerOutputs::value_of(std::string_view name) const {
  if (!type_of(name)) {
    return std::nullopt;
  }
  if (name == "timestamp") {
    return twin_.controller_s_;
  }
  if (name == "target_q" || name == "actual_q") {
    return array_of(twin_.motion_.joints_rad());
  }
  if (name == "target_qd" || name == "actual_qd") {
    return array_of(twin_.motion_.speed_rad_s());
  }
  if (name == "actual_TCP_pose" || name == "target_TCP_pose") {
    return pose_array(twin_.settings_.arm.forward(twin_.motion_.joints_rad()) * twin_.tcp());
  }
  if (name == "actual_TCP_speed" || name == "target_TCP_speed") {
    return tool_speed();
  }
  if (name == "tcp_offset") {
    return pose_array(twin_.tcp());
  }
  if (name == "payload") {
    return twin_.settings_.payload_kg + (twin_.has_wrong_payload_ ? 1.0 : 0.0);
  }
  if (name == "payload_cog") {
    const Eigen::Vector3d cog_m = kMPerMm * twin_.settings_.payload_cog_mm;
    return std::array<double, 3>{cog_m.x(), cog_m.y(), cog_m.z()};
  }
  return plain_value_of(name);
}

std::uint32_t ControllerOutputs::status_bits() const {
  const bool has_power =
      twin_.robot_mode_ == RobotMode::kRunning || twin_.robot_mode_ == RobotMode::kIdle;
  return (has_power ? kStatusPowerOn : 0U) |
         (twin_.program_ || twin_.has_other_program_ ? kStatusProgramRunning : 0U);
}

RtdeValue ControllerOutputs::plain_value_of(std::string_view name) const {
  if (name == "robot_mode") {
    return static_cast<std::int32_t>(twin_.robot_mode_);
  }
  if (name == "safety_mode" || name == "safety_status") {
    return static_cast<std::int32_t>(twin_.safety_mode_);
  }
  if (name == "runtime_state") {
    return static_cast<std::uint32_t>(twin_.runtime_state());
  }
  if (name == "robot_status_bits") {
    return status_bits();
  }
  if (name == "safety_status_bits") {
    return safety_status_bits(twin_.safety_mode_);
  }
  if (name == "actual_digital_output_bits") {
    return twin_.digital_outputs_;
  }
  if (name == kTwinTokenOutput) {
    return twin_.settings_.token;
  }
  if (name.starts_with("output_int_register_")) {
    return twin_.int_registers_.at(register_number(name));
  }
  if (name.starts_with("output_double_register_")) {
    return twin_.double_registers_.at(register_number(name));
  }
  return constant_value_of(name);
}

}  // namespace glint

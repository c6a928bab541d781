// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/robot_state.h"

#include <cmath>

#include <fmt/format.h>

#include "core/units.h"
#include "hardware/robot/rtde_client.h"

namespace glint {
namespace {

constexpr double kMmPerM = 1000.0;

JointVector vector_of(const std::array<double, 6>& values) {
  return Eigen::Map<const JointVector>(values.data());
}

Eigen::Isometry3d pose_of(std::array<double, 6> values) {
  for (std::size_t i = 0; i < 3; ++i) {
    values[i] *= kMmPerM;
  }
  return pose_of_six({values.begin(), values.end()});
}

std::string register_name(int number) {
  return fmt::format("output_int_register_{}", number);
}

std::string payload_difference(const RobotState& state, const UrSettings& settings) {
  constexpr double kSameKg = 0.01;
  constexpr double kSameMm = 1.0;
  if (!state.payload_kg || !state.payload_cog_mm) {
    return "the controller does not report its payload; its software is too old to be moved by "
           "Glint";
  }
  if (!(std::abs(*state.payload_kg - settings.payload_kg) <= kSameKg)) {
    return fmt::format("the pendant's payload is {:.3f} kg, robot.payload_kg is {:.3f}",
                       *state.payload_kg,
                       settings.payload_kg);
  }
  const Eigen::Vector3d cog_mm = Eigen::Map<const Eigen::Vector3d>(settings.payload_cog_mm.data());
  const double apart_mm = (*state.payload_cog_mm - cog_mm).norm();
  if (!(apart_mm <= kSameMm)) {
    return fmt::format("the pendant's centre of gravity is {:.1f} mm from robot.payload_cog_mm",
                       apart_mm);
  }
  return {};
}

}  // namespace

bool RobotState::is_program_running() const {
  return runtime_state != RuntimeState::kStopped ||
         (robot_status_bits & kStatusProgramRunning) != 0;
}

bool RobotState::is_guided() const {
  return (robot_status_bits & kStatusTeachButton) != 0;
}

bool RobotState::is_pose_known() const {
  return actual_q_rad.allFinite() && actual_qd_rad_s.allFinite() &&
         base_from_tcp.matrix().allFinite();
}

// The largest of numbers of which one is none would be any of them: each is compared.
bool RobotState::is_still() const {
  constexpr double kStillRadS = 1e-3;
  return (actual_qd_rad_s.array().abs() < kStillRadS).all();
}

std::vector<std::string> state_outputs(int ack_register) {
  return {"timestamp",
          "target_q",
          "actual_q",
          "actual_qd",
          "actual_TCP_pose",
          "actual_TCP_speed",
          "robot_mode",
          "safety_mode",
          "runtime_state",
          "robot_status_bits",
          "safety_status_bits",
          "speed_scaling",
          "actual_digital_output_bits",
          register_name(ack_register)};
}

std::vector<std::string> newer_outputs() {
  return {"tcp_offset", "payload", "payload_cog", "target_speed_fraction"};
}

RobotState state_of(const RtdeClient& client, int ack_register) {
  RobotState state;
  state.timestamp_s = client.get<double>("timestamp");
  state.target_q_rad = vector_of(client.get<std::array<double, 6>>("target_q"));
  state.actual_q_rad = vector_of(client.get<std::array<double, 6>>("actual_q"));
  state.actual_qd_rad_s = vector_of(client.get<std::array<double, 6>>("actual_qd"));
  state.base_from_tcp = pose_of(client.get<std::array<double, 6>>("actual_TCP_pose"));
  const JointVector speed = vector_of(client.get<std::array<double, 6>>("actual_TCP_speed"));
  state.tool_speed_mm_s = kMmPerM * speed.head<3>().norm();
  state.robot_mode = static_cast<RobotMode>(client.get<std::int32_t>("robot_mode"));
  state.safety_mode = static_cast<SafetyMode>(client.get<std::int32_t>("safety_mode"));
  state.runtime_state = static_cast<RuntimeState>(client.get<std::uint32_t>("runtime_state"));
  state.robot_status_bits = client.get<std::uint32_t>("robot_status_bits");
  state.safety_status_bits = client.get<std::uint32_t>("safety_status_bits");
  state.speed_scaling = client.get<double>("speed_scaling");
  state.digital_outputs = client.get<std::uint64_t>("actual_digital_output_bits");
  state.ack = client.get<std::int32_t>(register_name(ack_register));
  if (client.has("target_speed_fraction")) {
    state.slider = client.get<double>("target_speed_fraction");
  }
  if (client.has("tcp_offset")) {
    state.tcp_offset = pose_of(client.get<std::array<double, 6>>("tcp_offset"));
  }
  if (client.has("payload") && client.has("payload_cog")) {
    const auto cog_m = client.get<std::array<double, 3>>("payload_cog");
    state.payload_kg = client.get<double>("payload");
    state.payload_cog_mm = kMmPerM * Eigen::Map<const Eigen::Vector3d>(cog_m.data());
  }
  return state;
}

std::string tcp_difference(const RobotState& state,
                           const ArmWithTool& arm,
                           const UrSettings& settings) {
  const bool is_calibrated = !settings.arm_deltas.empty();
  const double same_mm = state.tcp_offset ? 0.1 : is_calibrated ? 1.0 : 5.0;
  const double same_rad = state.tcp_offset ? 1e-3 : is_calibrated ? 5e-3 : 20e-3;
  const JointVector left =
      state.tcp_offset
          ? pose_difference(*state.tcp_offset, arm.flange_from_tcp)
          : pose_difference(state.base_from_tcp, arm.base_from_tcp(state.actual_q_rad));
  if (left.head<3>().norm() <= same_mm && left.tail<3>().norm() <= same_rad) {
    return {};
  }
  return fmt::format("the pendant's TCP is {:.2f} mm and {:.3f} degrees from robot.flange_from_tcp",
                     left.head<3>().norm(),
                     left.tail<3>().norm() * kDegPerRad);
}

std::string readiness_problem(const RobotState& state) {
  if (!allows_motion(state.safety_mode)) {
    return fmt::format("the robot is stopped: safety mode {}", name_of(state.safety_mode));
  }
  if (state.robot_mode != RobotMode::kRunning) {
    return fmt::format("the robot is not ready: robot mode {}", name_of(state.robot_mode));
  }
  if (state.is_guided()) {
    return "the teach button is pressed: somebody guides the arm by hand";
  }
  if (state.is_program_running()) {
    return fmt::format("another program runs on the controller: {}", name_of(state.runtime_state));
  }
  return state.is_pose_known() ? "" : "the robot's pose is unknown";
}

std::string motion_refusal(const RobotState& state,
                           const ArmWithTool& arm,
                           const UrSettings& settings) {
  if (std::string text = readiness_problem(state); !text.empty()) {
    return text;
  }
  if (std::string text = tcp_difference(state, arm, settings); !text.empty()) {
    return text;
  }
  return payload_difference(state, settings);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hardware/robot/kinematics/denavit_hartenberg.h"
#include "hardware/robot/protocol/robot_modes.h"
#include "hardware/robot/ur_settings.h"

namespace glint {

class RtdeClient;

/// What a controller said in one package, with lengths in mm.
struct RobotState {
  double age_s = 0.0;        ///< since the package came
  double timestamp_s = 0.0;  ///< of the controller's own clock
  JointVector target_q_rad = JointVector::Zero();
  JointVector actual_q_rad = JointVector::Zero();
  JointVector actual_qd_rad_s = JointVector::Zero();
  Eigen::Isometry3d base_from_tcp = Eigen::Isometry3d::Identity();  ///< with the pendant's TCP
  double tool_speed_mm_s = 0.0;
  RobotMode robot_mode = RobotMode::kDisconnected;
  SafetyMode safety_mode = SafetyMode::kUndefined;
  RuntimeState runtime_state = RuntimeState::kStopped;
  std::uint32_t robot_status_bits = 0;
  std::uint32_t safety_status_bits = 0;
  double speed_scaling = 0.0;
  std::optional<double> slider;  ///< of the pendant, 0 to 1; none: the controller does not tell
  std::uint64_t digital_outputs = 0;
  std::int32_t ack = 0;                         ///< of the register that scripts write
  std::optional<Eigen::Isometry3d> tcp_offset;  ///< none: the controller's software is too old
  std::optional<double> payload_kg;             ///< none: too old
  std::optional<Eigen::Vector3d> payload_cog_mm;

  bool is_program_running() const;

  /// The teach button is pressed: somebody has a hand at the arm.
  bool is_guided() const;

  /// Joints, their speeds and the pose of the TCP are numbers.
  bool is_pose_known() const;

  /// No joint is faster than 1e-3 rad/s.
  bool is_still() const;
};

/// Outputs that a state needs, and those that newer controllers tell besides.
std::vector<std::string> state_outputs(int ack_register);
std::vector<std::string> newer_outputs();

/// The newest package as a state. @param client  is streaming
RobotState state_of(const RtdeClient& client, int ack_register);

/// Why neither a motion can begin in this state nor a standstill be relied on: stopped by safety,
/// not running, guided by hand, a program runs, joints or pose are no numbers; empty: nothing
/// speaks against it.
std::string readiness_problem(const RobotState& state);

/// Why the arm must not be moved in this state: readiness_problem(), or the pendant's TCP or
/// payload differ from the cell's; empty: nothing speaks against it.
std::string motion_refusal(const RobotState& state,
                           const ArmWithTool& arm,
                           const UrSettings& settings);

/// How far the pendant's TCP is from the cell's; empty: they agree. Compared is the controller's
/// tcp_offset, to 0.1 mm and 1 mrad; where it tells none, its pose of the TCP against the arm's own
/// forward kinematics, to 5 mm and 20 mrad, or 1 mm and 5 mrad for a calibrated arm.
std::string tcp_difference(const RobotState& state,
                           const ArmWithTool& arm,
                           const UrSettings& settings);

}  // namespace glint

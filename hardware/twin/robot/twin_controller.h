// SPDX-License-Identifier: GPL-3.0-or-later
//
// The twin of a UR controller without a network: an arm, modes of robot and safety, one program,
// and what RTDE, dashboard and primary interface tell of it. Its clock is whatever step() is given.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hardware/robot/protocol/primary_message.h"
#include "hardware/robot/protocol/robot_modes.h"
#include "hardware/robot/protocol/rtde_package.h"
#include "hardware/robot/ur_settings.h"
#include "hardware/twin/robot/arm_motion.h"
#include "hardware/twin/robot/controller_outputs.h"
#include "hardware/twin/robot/fault.h"
#include "hardware/twin/robot/script_program.h"
#include "hardware/twin/robot/script_threads.h"

namespace glint {

struct TwinSettings {
  Arm arm = Arm(ArmModel::kUr3);  ///< as the controller knows it
  JointVector start_rad = JointVector::Zero();
  Eigen::Isometry3d flange_from_tcp = Eigen::Isometry3d::Identity();  ///< set on the pendant, mm
  double payload_kg = 0.0;
  Eigen::Vector3d payload_cog_mm = Eigen::Vector3d::Zero();
  std::uint64_t token = 0;        ///< told by the output glint_twin_token; 0: there is none
  bool has_newer_outputs = true;  ///< tcp_offset, payload and payload_cog
  std::string serial_number = "20190000000";
  /// Each motion waits at its start until hold_motion(false): somebody has to make a picture of
  /// its goal first.
  bool holds_motions = false;
};

/// What the twin of a camera has to know of the arm.
struct TwinView {
  double time_s = 0.0;  ///< since the twin began; never goes back
  JointVector joints_rad = JointVector::Zero();
  bool is_still = true;
  std::optional<JointVector> goal_rad;  ///< where the motion leads; the joints when still
  std::uint64_t digital_outputs = 0;
  bool is_held = false;  ///< a motion waits
};

class TwinController {
 public:
  explicit TwinController(const TwinSettings& settings);
  TwinController(const TwinController&) = delete;
  TwinController& operator=(const TwinController&) = delete;

  /// One cycle: 8 ms (CB3) or 2 ms (e-Series).
  void step(double dt_s);

  double rate_hz() const { return is_cb3(settings_.arm.model()) ? 125.0 : 500.0; }

  ControllerVersion version() const;

  ControllerOutputs outputs() const { return ControllerOutputs(*this); }

  /// Inputs of one package: digital outputs where the mask has bits, registers.
  void set_inputs(const std::vector<std::string>& names, const std::vector<RtdeValue>& values);

  /// Names of all inputs that anybody has written since the twin began.
  const std::set<std::string>& inputs_written() const { return inputs_written_; }

  /// A program begins, or is refused with a message.
  void run(const ScriptReader::Result& script);

  /// The reply to a line on the dashboard, without newline.
  std::string reply(std::string_view line);

  /// What the primary interface has to tell; taken away.
  std::vector<PrimaryMessage> take_messages() { return std::exchange(messages_, {}); }

  /// What the network has to do; taken away.
  std::vector<FaultKind> take_network_faults() { return std::exchange(network_faults_, {}); }

  void add_fault(const Fault& fault) { faults_.push_back(fault); }

  /// How many faults have come to act.
  int num_faults_applied() const { return num_faults_applied_; }

  /// Stamps stand still, or nothing is sent.
  bool has_old_stamps() const { return has_old_stamps_; }

  bool is_silent() const { return is_silent_; }

  /// The controller has restarted: its clock, program and registers begin anew; the arm stays.
  void restart();

  /// Motions wait while this is set, and the clock with them: it goes on by a thousandth, so that
  /// stamps still grow.
  void hold_motion(bool is_held) { is_held_ = is_held; }

  TwinView view() const;

  RobotMode robot_mode() const { return robot_mode_; }

  SafetyMode safety_mode() const { return safety_mode_; }

  bool is_program_running() const { return program_.has_value(); }

 private:
  friend class ControllerOutputs;
  friend class DashboardReplies;

  void apply_due_faults(double dt_s);
  void apply(FaultKind kind);
  void release();
  void end_program();
  void stop_by_safety(SafetyMode mode);
  void pause_program();
  void advance_power(double dt_s);
  void advance_program(double dt_s);
  void advance_threads(double dt_s);
  bool execute(const ScriptStatement& statement);
  bool execute_motion(const ScriptStatement& statement);
  bool write_register(const ScriptStatement& statement);
  bool set_output(const ScriptStatement& statement);
  void fail_program(const std::string& why);
  void tell(PrimaryMessage::Kind kind, const std::string& text);
  Eigen::Isometry3d tcp() const;
  RuntimeState runtime_state() const;

  TwinSettings settings_;
  ArmMotion motion_;
  double time_s_ = 0.0;        ///< of the twin
  double controller_s_ = 0.0;  ///< of the controller since its restart
  RobotMode robot_mode_ = RobotMode::kRunning;
  SafetyMode safety_mode_ = SafetyMode::kNormal;
  double stopped_at_s_ = 0.0;  ///< when safety_mode_ last became a stop
  double powering_s_ = 0.0;    ///< how long the change of power has still to go
  RobotMode powering_to_ = RobotMode::kRunning;
  std::optional<ScriptProgram> program_;
  std::size_t next_statement_ = 0;
  double sleep_s_ = 0.0;
  ScriptThreads threads_;  ///< of the program
  std::array<std::int32_t, 48> int_registers_ = {};
  std::array<double, 48> double_registers_ = {};
  std::array<std::int32_t, 48> int_inputs_ = {};
  std::array<double, 48> double_inputs_ = {};
  std::uint64_t digital_outputs_ = 0;
  std::set<std::string> inputs_written_;
  std::vector<Fault> faults_;
  int num_faults_applied_ = 0;
  double moving_s_ = 0.0;  ///< how long the arm has been moving
  double still_s_ = 0.0;   ///< how long it has been standing still since it last moved
  bool has_moved_ = false;
  bool is_silent_ = false;
  bool has_old_stamps_ = false;
  bool has_wrong_tcp_ = false;
  bool has_wrong_payload_ = false;
  bool is_overspeed_ = false;
  bool is_remote_ = true;
  bool has_other_program_ = false;
  bool is_held_ = false;
  std::vector<PrimaryMessage> messages_;
  std::vector<FaultKind> network_faults_;
};

}  // namespace glint

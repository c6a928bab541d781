// SPDX-License-Identifier: GPL-3.0-or-later
//
// The product's driver and a twin without a network, on one injected clock.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/rng.h"
#include "hardware/robot/ur_driver.h"
#include "hardware/twin/robot/rtde_session.h"
#include "hardware/twin/robot/twin_controller.h"

namespace glint {

TwinSettings test_twin(ArmModel model);

/// Any fault but the one that takes others back.
Fault random_fault(Rng& rng);

/// After it nothing moves the arm any more.
bool is_stop(MotionOutcome outcome);

class TwinHarness {
 public:
  explicit TwinHarness(ArmModel model = ArmModel::kUr3e);

  /// @param settings  of the twin; the driver knows the nominal arm
  explicit TwinHarness(const TwinSettings& settings);

  /// Cycles of the controller for so long.
  void run(double duration_s);

  /// The same without a script going out.
  void run_without_scripts(double duration_s);

  /// Begins a motion, and runs until it has a result.
  /// @return none: it has none within 60 s
  std::optional<MotionResult> move(const JointVector& goal_rad, double share = 1.0);
  std::optional<MotionResult> move_line(const Eigen::Isometry3d& base_from_tcp, double share = 1.0);

  /// How far the joints of the twin move within a time, all motions added.
  double motion_rad(double duration_s);

  double now_s() const { return now_s_; }

  /// When the newest fault came to act; none: none did.
  std::optional<double> fault_at_s() const { return fault_at_s_; }

  /// Leaves the controller its programs after a stop, which the product never does.
  void leave_programs() { leaves_programs_ = true; }

  /// Bytes that were sent as scripts.
  const std::string& scripts() const { return scripts_; }

  /// Bytes that were sent to RTDE.
  const std::string& requests() const { return requests_; }

  TwinController twin;
  UrDriver driver;

 private:
  void cycle();
  void pass_scripts();
  void pass_packages();
  void pass_to_driver(const std::string& bytes);
  void look_for_fault();
  std::optional<MotionResult> finish(const CheckedMotion& motion);

  HeldInputs held_;
  std::unique_ptr<RtdeSession> session_;
  ScriptReader reader_;
  std::string scripts_;
  std::string requests_;
  double now_s_ = 0.0;
  bool leaves_programs_ = false;
  bool is_split_ = false;
  bool is_linked_ = true;
  std::optional<double> fault_at_s_;
};

}  // namespace glint

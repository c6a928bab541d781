// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "hardware/robot/motion_permit.h"
#include "hardware/robot/robot.h"
#include "hardware/robot/ur_driver.h"

namespace glint {

/// A Universal Robots arm: RTDE outputs for its state, scripts on the primary interface for motion,
/// the dashboard for what RTDE does not tell. A thread of its own reads; all functions may be
/// called from any one other thread.
class UrRobot final : public Robot {
 public:
  /// Connects to RTDE and waits for the first package. Sends no input recipe, and opens no other
  /// port.
  /// @throws IoError, ProtocolError
  UrRobot(const UrSettings& settings, const ArmWithTool& arm, double timeout_s = 3.0);
  ~UrRobot();  // NOLINT(modernize-use-override): declared in the plain form
  UrRobot(const UrRobot&) = delete;
  UrRobot& operator=(const UrRobot&) = delete;

  /// Opens the primary interface, so that scripts can be sent. On e-Series asks the dashboard
  /// whether the controller takes them.
  /// @throws IoError; ConfigError when remote control is off, or the dashboard does not tell
  void allow_motion(const MotionPermit& permit);

  /// Above 0 the arm is stopped where it is, and no motion begins.
  /// @param interrupts  outlives this
  void set_interrupt(const std::atomic<int>& interrupts) { interrupts_ = &interrupts; }

  std::optional<RobotState> state() const override;
  MotionResult move_joints(const JointVector& goal_rad, double share) override;
  MotionResult move_line(const Eigen::Isometry3d& base_from_tcp, double share) override;
  MotionResult stop() override;
  std::optional<StillPose> still_pose(double timeout_s) override;

  std::optional<MotionResult> halted() const override;

  ControllerVersion controller() const;

  /// Packages of RTDE that have come, and their rate.
  std::uint64_t num_packages() const;
  double rate_hz() const;

  /// The controller's address lies in 127.0.0.0/8.
  bool is_loopback() const;

 private:
  struct Impl;
  using Begin = std::function<std::optional<MotionResult>(UrDriver&, double)>;

  bool is_interrupted() const { return interrupts_ != nullptr && *interrupts_ > 0; }

  std::optional<MotionResult> refusal();
  MotionResult move(const std::function<CheckedMotion(const RobotState&)>& check);
  MotionResult run(const Begin& begin);
  MotionResult explained(const MotionResult& result);

  std::unique_ptr<Impl> impl_;
  const std::atomic<int>* interrupts_ = nullptr;
};

}  // namespace glint

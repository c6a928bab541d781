// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "hardware/light/light.h"
#include "hardware/robot/motion_permit.h"
#include "hardware/robot/robot.h"

namespace glint {

/// The eight standard digital outputs of a robot's controller: set by an input recipe of RTDE on a
/// connection of its own (digital_outputs.h), read from the robot's states.
class RobotOutputs final : public DigitalOutputs {
 public:
  /// @param robot  outlives this
  RobotOutputs(std::string host, int rtde_port, const Robot& robot, const MotionPermit& permit)
      : host_(std::move(host)), rtde_port_(rtde_port), robot_(robot), permit_(permit) {}

  int num_outputs() const override { return 8; }

  void set_output(int index, bool is_on) override;

  std::uint64_t outputs() const override;

 private:
  std::string host_;
  int rtde_port_;
  const Robot& robot_;
  MotionPermit permit_;
};

}  // namespace glint

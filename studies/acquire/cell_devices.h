// SPDX-License-Identifier: GPL-3.0-or-later
//
// The devices of a cell, connected: what an acquisition is made with.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hardware/acquisition/acquisition.h"
#include "hardware/acquisition/robot_outputs.h"
#include "hardware/robot/motion_permit.h"
#include "hardware/robot/ur_robot.h"
#include "studies/cell/cell_file.h"

namespace glint {

/// Asks a person to switch one of several lights, as ConfirmSwitch does.
using ConfirmLight =
    std::function<bool(const std::string& light, bool is_on, const std::string& what)>;

class CellDevices {
 public:
  /// @param confirm       asks a person to switch the light of that name
  /// @param positions, steps  of the scan
  /// @throws ConfigError, IoError; nothing has moved then
  CellDevices(const Cell& cell,
              const MotionPermit& permit,
              const ConfirmLight& confirm,
              int positions,
              const ScanSteps& steps);

  AcquisitionDevices devices();

  /// The robot has proved that it is a twin.
  bool is_twin() const { return is_twin_; }

  const CameraDescription& camera() const { return camera_->description(); }

 private:
  bool is_twin_ = false;
  std::unique_ptr<UrRobot> robot_;
  std::unique_ptr<RobotOutputs> outputs_;
  std::unique_ptr<Camera> camera_;
  std::vector<std::unique_ptr<Light>> lights_;
  std::vector<CellLamp> lamps_;
  ConnectedStage stage_;
};

}  // namespace glint

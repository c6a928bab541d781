// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/cell_devices.h"

#include <chrono>
#include <thread>

#include "core/wall_clock.h"
#include "studies/cell/ready_file.h"
#include "studies/cell_camera/cell_camera.h"

namespace glint {
namespace {

/// A camera that belonged to a process which was killed is free some seconds later.
std::unique_ptr<Camera> open_patiently(const CellCamera& settings) {
  constexpr double kPatienceS = 15.0;
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    try {
      return open_camera_of(settings);
    } catch (const IoError&) {
      if (seconds_since(start) > kPatienceS) {
        throw;
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

}  // namespace

CellDevices::CellDevices(const Cell& cell,
                         const MotionPermit& permit,
                         const ConfirmLight& confirm,
                         int positions,
                         const ScanSteps& steps) {
  throw_if_any(shared_outputs(cell));
  const UrSettings& robot = robot_of(cell);
  is_twin_ = is_robot_twin(cell);
  check_camera_twin(cell);
  check_stage_twin(cell);
  robot_ = std::make_unique<UrRobot>(robot, arm_with_tool(robot, cell.limits));
  outputs_ = std::make_unique<RobotOutputs>(robot.host, robot.rtde_port, *robot_, permit);
  camera_ = open_patiently(camera_of(cell));
  for (const CellLight& light : cell.lights) {
    const bool is_manual = light.kind == CellLight::Kind::kManual;
    if (is_manual) {
      lights_.push_back(std::make_unique<PromptedLight>(
          light.name, [confirm, name = light.name](bool is_on, const std::string& what) {
            return confirm(name, is_on, what);
          }));
    } else {
      lights_.push_back(std::make_unique<OutputLight>(light.name, *outputs_, light.output));
    }
    lamps_.push_back(
        {.light = lights_.back().get(), .settle_s = light.settle_s, .is_left_on = is_manual});
  }
  if (cell.stage) {
    stage_ = connect_stage(*cell.stage, positions, steps);
  }
  robot_->allow_motion(permit);
}

AcquisitionDevices CellDevices::devices() {
  return {.robot = *robot_, .camera = *camera_, .lamps = lamps_, .stage = stage_.stage.get()};
}

}  // namespace glint

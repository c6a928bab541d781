// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/acquisition/robot_outputs.h"

#include <chrono>
#include <thread>

#include "core/error.h"
#include "core/wall_clock.h"
#include "hardware/robot/digital_outputs.h"

namespace glint {

void RobotOutputs::set_output(int index, bool is_on) {
  const auto bit = static_cast<std::uint8_t>(1U << static_cast<unsigned>(index));
  set_digital_outputs(host_, rtde_port_, bit, is_on ? bit : std::uint8_t{0}, permit_);
  // The robot's own packages come on another connection, some milliseconds later.
  constexpr double kFollowS = 0.5;
  const auto start = std::chrono::steady_clock::now();
  while (((outputs() & bit) != 0) != is_on && seconds_since(start) < kFollowS) {
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
}

std::uint64_t RobotOutputs::outputs() const {
  const auto state = robot_.state();
  if (!state) {
    throw IoError("the robot reports nothing of its outputs");
  }
  return state->digital_outputs;
}

}  // namespace glint

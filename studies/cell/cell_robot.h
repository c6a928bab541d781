// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint cell` does with the robot of a cell. Each function returns the object that --json
// prints; "ok" tells whether the program ends with exit code 0 or 1.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "hardware/robot/motion_permit.h"
#include "studies/cell/cell_file.h"

namespace glint {

/// Mode, joints, pose, and why it could not be moved now. Sends nothing that moves or changes it.
nlohmann::ordered_json robot_status(const Cell& cell);

/// The state again and again, until the time is over or the function says so. The same restraint.
/// @param tell  called with each state; false: enough
nlohmann::ordered_json watch_robot(const Cell& cell,
                                   double duration_s,
                                   double every_s,
                                   const std::function<bool(const nlohmann::ordered_json&)>& tell);

struct CellMotion {
  double share = 0.5;    ///< of the limits of speed, in (0, 1]
  bool is_line = false;  ///< the TCP goes straight (movel) instead of the joints (movej)
  const std::atomic<int>* interrupt = nullptr;  ///< above 0: the arm is stopped where it is
};

/// To a position of the cell, and what the arm's pose is when it stands still there. A line takes
/// the TCP where the position's joints have it, and may arrive with other joints. "status" is
/// "interrupted" when the arm did not arrive for that.
nlohmann::ordered_json move_robot(const Cell& cell,
                                  const CellPosition& position,
                                  const CellMotion& motion,
                                  const MotionPermit& permit);

/// Takes away a protective stop, and waits until it is gone. The stop has to be 5 s old; of any
/// other safety mode nothing is sent.
nlohmann::ordered_json unlock_robot(const Cell& cell, const MotionPermit& permit);

/// Power on and brakes released, or power off.
nlohmann::ordered_json power_robot(const Cell& cell, bool is_on, const MotionPermit& permit);

}  // namespace glint

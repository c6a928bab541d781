// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hardware/twin/robot/twin_server.h"
#include "tests/hardware/robot/cell_robot_settings.h"
#include "tests/hardware/twin/robot/twin_harness.h"

namespace glint {

inline TwinServerSettings on_free_ports(ArmModel model) {
  return {.twin = test_twin(model), .address = "127.0.0.1", .ports = {0, 0, 0, 0}};
}

/// The cell's robot, which is the twin that is served.
inline UrSettings settings_for(const TwinServer& server, ArmModel model) {
  UrSettings settings = test_robot(model);
  settings.rtde_port = server.ports().rtde;
  settings.primary_port = server.ports().primary;
  settings.secondary_port = server.ports().secondary;
  settings.dashboard_port = server.ports().dashboard;
  return settings;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <fmt/format.h>

namespace glint::test {

/// A cell with a UR3, a safe position and a view 10 degrees from it.
inline std::string cell_text(int rtde, int primary, int secondary, int dashboard) {
  return fmt::format(R"([robot]
model = "ur3"
host = "127.0.0.1"
rtde_port = {}
primary_port = {}
secondary_port = {}
dashboard_port = {}
flange_from_tcp = [0, 0, 80, 0, 0, 0]
tool_radius_mm = 35
payload_kg = 0.6
payload_cog_mm = [0, 0, 40]
[limits]
tool_speed_mm_s = 250
tool_acceleration_mm_s2 = 500
joint_speed_deg_s = 60
joint_acceleration_deg_s2 = 120
box_min_mm = [-600, -600, 20]
box_max_mm = [600, 600, 900]
[[safe_position]]
name = "home"
joints_deg = [0, -100, 100, -90, -90, 0]
[[view]]
name = "left"
joints_deg = [10, -95, 95, -85, -90, 0]
)",
                     rtde,
                     primary,
                     secondary,
                     dashboard);
}

}  // namespace glint::test

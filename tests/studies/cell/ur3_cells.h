// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts of cell files: UR3 arms without cameras.
#pragma once

namespace glint::test {

/// With a tool of 80 mm and one safe position.
inline constexpr const char* kUr3Cell = R"([robot]
model = "ur3"
host = "127.0.0.1"
flange_from_tcp = [0, 0, 80, 0, 0, 0]
tool_radius_mm = 35
payload_kg = 0.6
[limits]
tool_speed_mm_s = 250
tool_acceleration_mm_s2 = 500
joint_speed_deg_s = 60
joint_acceleration_deg_s2 = 120
box_min_mm = [-600, -600, -50]
box_max_mm = [600, 600, 900]
[[safe_position]]
name = "high"
joints_deg = [0, -110, 70, -50, -90, 0]
)";

/// With a camera beside the flange; a cell needs a safe position, too.
inline constexpr const char* kUr3WithCamera = R"([robot]
model = "ur3"
host = "127.0.0.1"
flange_from_tcp = [0, 50, 30, 0, 0, 0]
tool_radius_mm = 40
payload_kg = 0.6
[limits]
tool_speed_mm_s = 250
tool_acceleration_mm_s2 = 800
joint_speed_deg_s = 60
joint_acceleration_deg_s2 = 200
box_min_mm = [-450, -450, -50]
box_max_mm = [500, 450, 700]
)";

}  // namespace glint::test

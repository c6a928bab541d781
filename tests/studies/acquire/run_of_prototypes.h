// SPDX-License-Identifier: GPL-3.0-or-later
//
// A run whose designs have lights that are built differently, and a cell that nobody serves.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "studies/acquire/mounted_prototypes.h"
#include "tests/support/temporary_folder.h"

namespace glint {

/// A plate under a ring of this outer radius and a bar, each as bright as told.
inline std::string scene_text(double radius_mm, double ring = 4, double bar = 8) {
  return fmt::format(R"(schema = 1
[part]
shape = "plate"
length_mm = 40
width_mm = 40
thickness_mm = 5
[material]
type = "diffuse"
[lighting.ring]
mount = "camera"
inner_radius_mm = 30
outer_radius_mm = {}
height_mm = 80
radiance = [{}]
[lighting.bar]
mount = "camera"
position_mm = [0, -100, 80]
direction = [0, 1, 1]
length_mm = 120
width_mm = 25
radiance = [{}]
)",
                     radius_mm,
                     ring,
                     bar);
}

/// A run with designs narrow and wide, whose rings differ, and dark, whose ring is off.
class PrototypesOfARun : public testing::Test {
 protected:
  PrototypesOfARun() {
    make_folder(folder_ / "run");
    write_file(folder_ / "run/study.resolved.toml", "schema = 1\n");
    write_file(scene("narrow"), scene_text(50));
    write_file(scene("wide"), scene_text(60));
    write_file(scene("dark"), scene_text(70, 0));
  }

  std::filesystem::path scene(const std::string& design) const {
    const std::filesystem::path folder = folder_ / "run" / design;
    make_folder(folder);
    return folder / "scene.toml";
  }

  MountedPrototypes prototypes(const std::vector<std::string>& mounted = {}) const {
    return MountedPrototypes::beside(scene("wide"), mounted);
  }

  TemporaryFolder folder_;
};

/// Nobody listens at its robot: whoever does not wait fails to connect.
inline constexpr const char* kLonelyCell = R"([camera]
address = "127.0.0.1"
[robot]
model = "ur3"
host = "127.0.0.1"
rtde_port = 1
flange_from_tcp = [0, 0, 80, 0, 0, 0]
tool_radius_mm = 35
payload_kg = 0.6
[limits]
tool_speed_mm_s = 250
tool_acceleration_mm_s2 = 500
joint_speed_deg_s = 60
joint_acceleration_deg_s2 = 120
box_min_mm = [-600, -600, 20]
box_max_mm = [600, 600, 900]
[lights.ring]
output = 0
[lights.bar]
output = 1
[[safe_position]]
joints_deg = [0, -100, 100, -90, -90, 0]
[[view]]
joints_deg = [10, -95, 95, -85, -90, 0]
)";

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/expected_parts.h"

#include <array>

#include <gtest/gtest.h>

#include "core/file.h"
#include "core/thread_pool.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_picture.h"
#include "studies/reach/scene_cell.h"
#include "tests/support/temporary_folder.h"

namespace glint::acquire_detail {
namespace {

/// A bent strip that fills half the picture, turned and shifted in the scene, seen at a slant by a
/// lens with distortion, in a cell whose frames are all turned against each other.
constexpr const char* kScene = R"(schema = 2
[part]
shape = "strip"
length_mm = 40
width_mm = 12
radius_along_mm = 60
radius_across_mm = 40
position_mm = [3, -2, 0]
rotation_deg = [0, 0, 25]
[camera]
width_px = 320
height_px = 240
object_pixel_mm = 0.2
working_distance_mm = 180
k1 = -0.3
p1 = 0.002
[sensor]
wavelengths_nm = [630]
[lighting.ring]
mount = "camera"
[render.paths]
samples = 1
[calibration.flange_from_camera]
translation_mm = [10, 50, 30]
rotation_vector_deg = [5, -8, 30]
[cell.base_from_part]
translation_mm = [280, -120, 20]
rotation_vector_deg = [3, 6, 40]
[[viewpoint]]
position_mm = [40, -37, 170]
direction = [-0.2, 0.2, -0.96]
up = [0.34, 0.94, 0]
)";

constexpr const char* kCell = R"([robot]
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

/// Of 3 x 3 blocks around one how many pixels of the rendered part's mask there are, and of all.
std::array<int, 2> pixels_around(const Mask& rendered, int factor, int x, int y) {
  std::array<int, 2> counts = {0, 0};
  for (int v = std::max(0, (y - 1) * factor); v < std::min(rendered.height(), (y + 2) * factor);
       ++v) {
    for (int u = std::max(0, (x - 1) * factor); u < std::min(rendered.width(), (x + 2) * factor);
         ++u) {
      counts[0] += rendered(u, v) != 0 ? 1 : 0;
      ++counts[1];
    }
  }
  return counts;
}

TEST(ExpectedParts, AreWhereThePartIsRendered) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kScene);
  write_file(folder / "cell.toml", kCell);
  const SceneSettings scene = load_study(folder / "scene.toml", {}).scene;
  const Cell cell = read_cell(folder / "cell.toml");
  ThreadPool pool(1);
  SceneStore store(pool);
  const Mask rendered = picture_of(store, scene, {.has_flawless = false})->traced()->part_mask;

  const auto requests = view_requests(scene, cell, scene.viewpoints);
  const Eigen::Isometry3d flange_from_camera =
      isometry_of(cell_chain(scene, cell).carrier_from_camera);
  const PlannedView view = {.base_from_flange =
                                requests[0].base_from_camera * flange_from_camera.inverse()};
  const ExpectedParts expected = expected_parts(scene, cell, std::array{view});
  ASSERT_EQ(expected.masks.size(), 1U);
  const Mask& mask = expected.masks[0];
  ASSERT_EQ(mask.width(), 160);
  int on_part = 0;
  int wrong = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      const auto [part, all] = pixels_around(rendered, 2, x, y);
      on_part += part == all ? 1 : 0;
      wrong += (part == all && mask(x, y) == 0) || (part == 0 && mask(x, y) != 0) ? 1 : 0;
    }
  }
  EXPECT_GT(on_part, 500);
  EXPECT_EQ(wrong, 0) << "of " << mask.width() * mask.height();
}

}  // namespace
}  // namespace glint::acquire_detail

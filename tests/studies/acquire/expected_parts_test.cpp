// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/expected_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/thread_pool.h"
#include "hardware/acquisition/picture_check.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_picture.h"
#include "studies/reach/scene_cell.h"
#include "tests/studies/cell/ur3_cells.h"
#include "tests/studies/validate/trial_cell.h"
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

/// The first view of a scene, where the flange has to be for it.
PlannedView first_view_of(const SceneSettings& scene, const Cell& cell) {
  const auto requests = view_requests(scene, cell, scene.viewpoints);
  const Eigen::Isometry3d flange_from_camera =
      isometry_of(cell_chain(scene, cell).carrier_from_camera);
  return {.base_from_flange = requests[0].base_from_camera * flange_from_camera.inverse()};
}

TEST(ExpectedParts, AreWhereThePartIsRendered) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kScene);
  write_file(folder / "cell.toml", test::kUr3Cell);
  const SceneSettings scene = load_study(folder / "scene.toml", {}).scene;
  const Cell cell = read_cell(folder / "cell.toml");
  ThreadPool pool(1);
  SceneStore store(pool);
  const Mask rendered = picture_of(store, scene, {.has_flawless = false})->traced()->part_mask;

  const ExpectedParts expected =
      expected_parts(scene, cell, std::array{first_view_of(scene, cell)});
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

Frame frame_of(const ImageF& grey) {
  Frame frame;
  frame.status = FrameStatus::kComplete;
  frame.codes = Image<std::uint16_t>(grey.width(), grey.height());
  std::ranges::transform(grey.values(), frame.codes.values().begin(), [](float level) {
    return static_cast<std::uint16_t>(std::lround(255.0F * std::clamp(level, 0.0F, 1.0F)));
  });
  return frame;
}

/// Means of 5 by 5 pixels: blurred by a sigma of the square root of 2.
ImageF means_of(const ImageF& grey) {
  ImageF means(grey.width(), grey.height());
  for (int y = 0; y < grey.height(); ++y) {
    for (int x = 0; x < grey.width(); ++x) {
      float sum = 0.0F;
      for (int k = 0; k < 25; ++k) {
        sum += grey(std::clamp(x + k % 5 - 2, 0, grey.width() - 1),
                    std::clamp(y + k / 5 - 2, 0, grey.height() - 1));
      }
      means(x, y) = sum / 25.0F;
    }
  }
  return means;
}

// A picture of its own, without others that it could be compared with.
TEST(ExpectedParts, TellARenderedPictureFromItsBlurredCopy) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kTrialScene);
  write_file(folder / "cell.toml", test::kUr3Cell);
  const SceneSettings scene = load_study(folder / "scene.toml", {}).scene;
  const Cell cell = read_cell(folder / "cell.toml");
  ThreadPool pool(1);
  SceneStore store(pool);
  const ImageF sharp = picture_of(store, first_view(store, scene), {.has_flawless = false})
                           ->mean({.has_whole_frames = true})
                           .aspect;
  const ExpectedParts parts = expected_parts(scene, cell, std::array{first_view_of(scene, cell)});
  ASSERT_EQ(parts.blur_px.size(), 1U);
  EXPECT_NEAR(parts.blur_px[0], 0.7, 1e-9) << "a pinhole: the sensor's alone";
  const ExpectedPicture expected = {
      .part = parts.masks[0], .tolerance_px = parts.tolerance_px, .blur_px = parts.blur_px[0]};
  const PictureLimits limits;
  const double max_px = blur_limit_px(limits, expected.blur_px);
  const auto fault = [&](const ImageF& grey) {
    return rejection_of(figures_of(frame_of(grey), expected, true), limits, 0.0, max_px);
  };
  EXPECT_EQ(fault(sharp), "");
  EXPECT_THAT(fault(means_of(means_of(means_of(sharp)))), testing::HasSubstr("blurred"));
}

// Focused at 150 mm with a pupil of 11 mm, the plate at 180 mm: a disc of 7 pixels, 8 at its lower
// side.
TEST(ExpectedParts, AreAsBlurredAsTheirLensMakesThem) {
  const TemporaryFolder folder;
  const std::string text = kTrialScene;
  write_file(folder / "scene.toml", text + "[lens]\nfocus_mm = 150\nf_number = 2\n");
  write_file(folder / "cell.toml", test::kUr3Cell);
  const SceneSettings scene = load_study(folder / "scene.toml", {}).scene;
  const Cell cell = read_cell(folder / "cell.toml");
  const double blur_px =
      expected_parts(scene, cell, std::array{first_view_of(scene, cell)}).blur_px.at(0);
  EXPECT_GT(blur_px, 1.8);
  EXPECT_LT(blur_px, 2.4);
}

}  // namespace
}  // namespace glint::acquire_detail

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/twin_cell/cell_pictures.h"

#include <numeric>

#include <gmock/gmock.h>

#include "tests/studies/twin_cell/small_cell.h"

namespace glint {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kLong{60000};

double mean_of(const Image<std::uint16_t>& image) {
  return std::accumulate(image.values().begin(), image.values().end(), 0.0) /
         static_cast<double>(image.size());
}

class SmallCell : public testing::Test {
 protected:
  ThreadPool pool_{2};
  CellRenderer renderer_{truth_of(kSmallTruth), pool_};
};

TEST_F(SmallCell, IsTheSamePictureForTheSameStateAndAnotherForAnother) {
  const CaptureSettings settings = {.exposure_us = 5000};
  const TwinCellState state = state_above(0, {"ring"});
  const auto picture = renderer_.render(state, settings);
  EXPECT_EQ(picture, renderer_.render(state, settings));
  EXPECT_NE(picture, renderer_.render(state_above(3, {"ring"}), settings));
  EXPECT_NE(picture, renderer_.render(state_above(0, {"bar"}), settings));
}

// Twice the exposure is twice the light as long as nothing is clipped; no light is nothing but
// noise about the black level: 40 of 4095 is 2.49 of 255.
TEST_F(SmallCell, FollowsExposureLightsAndBlackLevel) {
  const double once = mean_of(renderer_.render(state_above(0, {"ring"}), {.exposure_us = 2500}));
  const double twice = mean_of(renderer_.render(state_above(0, {"ring"}), {.exposure_us = 5000}));
  EXPECT_GT(once, 5.0);
  EXPECT_LT(twice, 250.0);
  EXPECT_NEAR(twice / once, 2.0, 0.03);
  const double dark = mean_of(renderer_.render(state_above(0, {}), {.black_level = 40}));
  EXPECT_NEAR(dark, 40.0 / 4095.0 * 255.0, 0.6);
}

// Twice as bright a truth is another picture of the same paths.
TEST_F(SmallCell, RendersWhatTruthsHaveInCommonOnce) {
  const CaptureSettings settings = {.exposure_us = 2500};
  const TwinCellState state = state_above(0, {"ring"});
  Truth brighter = truth_of(kSmallTruth);
  brighter.settings.exposure_s *= 0.5;
  SceneStore store(pool_);
  const auto picture = CellRenderer(truth_of(kSmallTruth), store).render(state, settings);
  EXPECT_EQ(picture, renderer_.render(state, settings));
  const auto bright = CellRenderer(brighter, store).render(state, settings);
  EXPECT_EQ(bright, CellRenderer(brighter, pool_).render(state, settings));
  EXPECT_NEAR(mean_of(bright) / mean_of(picture), 2.0, 0.03);
  EXPECT_EQ(store.num_rendered(), 1);
}

// 20 dB are a factor of ten: a mean below a tenth of full scale is ten times as high.
TEST_F(SmallCell, FollowsTheGainInDecibels) {
  const TwinCellState state = state_above(0, {"ring"});
  const double plain = mean_of(renderer_.render(state, {.exposure_us = 300, .bits = 16}));
  const double raised =
      mean_of(renderer_.render(state, {.exposure_us = 300, .gain_db = 20.0, .bits = 16}));
  EXPECT_NEAR(raised / plain, 10.0, 0.3);
}

TEST_F(SmallCell, HasNoPictureWhileTheArmMoves) {
  const TwinCellState here = state_above(0, {"ring"});
  const TwinCellState there = state_above(5, {"ring"});
  CellPictures pictures(renderer_, here);
  const CaptureSettings settings = {.exposure_us = 5000};
  pictures.prepare(settings);
  ASSERT_TRUE(pictures.wait_until_finished(kLong)) << pictures.error();
  const SensorPicture first = pictures.finished(settings, 0);
  ASSERT_NE(first, nullptr);
  pictures.announce(there);
  pictures.leave();
  EXPECT_EQ(pictures.finished(settings, 1), nullptr);
  ASSERT_TRUE(pictures.wait_until_finished(kLong));
  EXPECT_EQ(pictures.finished(settings, 1), nullptr);  // rendered, but the arm is not there yet
  pictures.arrive(there);
  const SensorPicture second = pictures.finished(settings, 1);
  ASSERT_NE(second, nullptr);
  EXPECT_EQ(*second, renderer_.render(there, settings));
  EXPECT_EQ(pictures.num_rendered(), 2);
}

/// A shiny strip under a tunnel of which a scan takes four positions.
constexpr const char* kTunnelTruth = R"(schema = 1
[part]
shape = "strip"
length_mm = 40
width_mm = 12
radius_along_mm = 400
radius_across_mm = 40
[camera]
width_px = 64
height_px = 32
object_pixel_mm = 0.75
working_distance_mm = 180
[render]
rays_per_axis = 1
[sensor]
full_well_e = 10000
read_noise_e = 6
[scan]
positions = 4
[lighting.tunnel]
shape = "semicylinder"
radius_mm = 80
slot_mm = 24
length_mm = 400
period_mm = 12
[truth]
camera_position_mm = [0, 40, 30]
scene_position_mm = [300, 0, 0]
)";

// All positions are rendered at once, and a stage that has moved finds its own.
TEST(TunnelCell, HasAPictureForEachPositionOfTheStage) {
  ThreadPool pool(2);
  CellRenderer renderer(truth_of(kTunnelTruth), pool);
  EXPECT_EQ(renderer.num_positions(), 4);
  EXPECT_NEAR(renderer.step_mm(), 3.0, 1e-9);  // a period of 12 mm in four steps
  const CaptureSettings settings = {.exposure_us = 10000};
  TwinCellState state = state_above(0, {"tunnel"});
  CellPictures pictures(renderer, state);
  TwinCellState now = state;
  pictures.set_live([&now] { return std::optional(now); });
  pictures.prepare(settings);
  ASSERT_TRUE(pictures.wait_until_finished(kLong)) << pictures.error();
  std::vector<Image<std::uint16_t>> seen;
  for (int position = 0; position < 4; ++position) {
    now.stage_position = position;
    state.stage_position = position;
    const SensorPicture picture = pictures.finished(settings, 0);
    ASSERT_NE(picture, nullptr);
    EXPECT_EQ(*picture, renderer.render(state, settings));
    EXPECT_EQ(std::ranges::find(seen, *picture), seen.end());
    seen.push_back(*picture);
  }
  EXPECT_EQ(pictures.num_rendered(), 1);
  now.lights = {};
  EXPECT_EQ(pictures.finished(settings, 0), nullptr) << "of lights that are not on any more";
}

// Stripes that the stage has taken 1.5 mm on look like those of a design with that offset.
TEST(TunnelCell, ShowsTheStripesWhereTheStageHasTakenThem) {
  ThreadPool pool(2);
  std::string text = kTunnelTruth;
  text.replace(text.find("full_well_e = 10000\nread_noise_e = 6"), 36, "full_well_e = 0\nbits = 8");
  CellRenderer renderer(truth_of(text), pool);
  text.replace(text.find("period_mm = 12"), 14, "period_mm = 12\noffset_mm = 1.5");
  CellRenderer shifted(truth_of(text), pool);
  EXPECT_DOUBLE_EQ(shifted.offset_mm(), 1.5);
  EXPECT_DOUBLE_EQ(renderer.period_mm(), 12.0);
  TwinCellState state = state_above(0, {"tunnel"});
  const auto wanted = shifted.render_all(state, {});
  EXPECT_NE(renderer.render_all(state, {}), wanted);
  state.stage_shift_mm = 1.5;
  EXPECT_EQ(renderer.render_all(state, {}), wanted);
}

TEST(TunnelCell, IsDarkWithoutALight) {
  ThreadPool pool(2);
  CellRenderer renderer(truth_of(kTunnelTruth), pool);
  const auto dark = renderer.render_all(state_above(0, {}), {.black_level = 0.0});
  ASSERT_EQ(dark.size(), 4U);
  EXPECT_LT(mean_of(dark[3]), 1.0);
}

}  // namespace
}  // namespace glint

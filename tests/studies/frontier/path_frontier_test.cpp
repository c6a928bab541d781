// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/path_frontier.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/rng.h"
#include "studies/frontier/design_ranking.h"
#include "studies/frontier/frontier_choice.h"
#include "studies/frontier/frontier_drawing.h"
#include "studies/frontier/frontier_methods.h"
#include "studies/frontier/frontier_page.h"
#include "studies/frontier/picture_errors.h"
#include "tests/studies/frontier/steel_under_ring.h"
#include "tests/studies/scene_from.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// With a dent.
const std::string kRingStudy = std::string(test::kSteelUnderRing) + R"(batches = 2
[defects.dent]
x_mm = [3]
y_mm = [2]
height_um = 400
diameter_mm = 6
)";

SceneSettings ring_scene() {
  return test::scene_from(kRingStudy);
}

const FrontierPoint& point_named(const Frontier& frontier, const std::string& label) {
  const auto found = std::ranges::find(frontier.points, label, &FrontierPoint::label);
  if (found == frontier.points.end()) {
    throw std::logic_error("there is no " + label);
  }
  return *found;
}

// Squares 9 and 25, mean 17; less 1 of noise: 4. One value at 3 of noise 5: nothing is left.
TEST(ScoreError, IsLessTheNoiseOfTheReference) {
  const std::vector<double> values = {3.0, 5.0};
  const ScoreError error = score_error(values, {.value = 0.0, .standard_error = 1.0});
  EXPECT_DOUBLE_EQ(error.error, 4.0);
  EXPECT_DOUBLE_EQ(error.value, 4.0);
  EXPECT_DOUBLE_EQ(error.spread, std::sqrt(2.0));
  const std::vector<double> one = {3.0};
  EXPECT_EQ(score_error(one, {.value = 0.0, .standard_error = 5.0}).error, 0.0);
}

/// Two frames of 30 x 20 pixels that are `bias` plus noise of a deviation.
std::vector<ImageF> noisy_frames(double bias, double deviation, Rng& rng) {
  std::vector<ImageF> frames(2, ImageF(30, 20));
  for (ImageF& frame : frames) {
    for (float& value : frame.values()) {
      // The sum of twelve uniform numbers has variance 1.
      double sum = -6.0;
      for (int i = 0; i < 12; ++i) {
        sum += rng.uniform();
      }
      value = static_cast<float>(0.5 + bias + deviation * sum);
    }
  }
  return frames;
}

TracedScene all_on_part() {
  TracedScene traced;
  traced.corners.width_px = 30;
  traced.corners.height_px = 20;
  traced.corners.coverage = ImageF(30, 20, 1.0F);
  traced.region.mask = Mask(30, 20);
  traced.region.mask(3, 4) = 1;
  return traced;
}

// Four pictures of deviation 0.04 have a mean of deviation 0.02; 1200 values tell it to 2 %.
TEST(ReferencePictures, KnowTheirOwnNoiseAndWhatABiasIs) {
  Rng rng(5, Stream::kTest, 0);
  ReferencePictures reference;
  const TracedScene traced = all_on_part();
  reference.add(traced, noisy_frames(0.0, 0.04, rng));
  EXPECT_EQ(reference.own_rmse(), 0.0) << "one picture has no scatter";
  for (int i = 0; i < 3; ++i) {
    reference.add(traced, noisy_frames(0.0, 0.04, rng));
  }
  EXPECT_NEAR(reference.own_rmse(), 0.02, 0.001);
  const PictureDistance same = reference.distance(noisy_frames(0.0, 0.0, rng), 1);
  EXPECT_NEAR(rms_less_noise(same.mean_square, reference.own_square()), 0.0, 0.006);
  EXPECT_GT(std::sqrt(same.mean_square), 0.018) << "else nothing is taken out";
  const PictureDistance biased = reference.distance(noisy_frames(0.03, 0.0, rng), 1);
  EXPECT_NEAR(rms_less_noise(biased.mean_square, reference.own_square()), 0.03, 0.001);
  const PictureDistance noisy = reference.distance(noisy_frames(0.0, 0.05, rng), 1);
  EXPECT_NEAR(rms_less_noise(noisy.mean_square, reference.own_square()), 0.05, 0.003);
}

TEST(PixelFactor, IsTheSmallestThatFits) {
  CameraSettings camera;
  camera.width_px = 2448;
  camera.height_px = 2050;
  EXPECT_EQ(pixel_factor(camera, 0.3e6), 5);  // 612 x 512 = 313344; 489 x 410 = 200490
  camera.width_px = 600;
  camera.height_px = 500;
  EXPECT_EQ(pixel_factor(camera, 0.3e6), 1);
}

TEST(FrontierMethods, OfAPathTracedSceneMarkWhatTheSceneHasNow) {
  const SceneSettings scene = ring_scene();
  std::vector<std::string> labels;
  std::vector<std::string> current;
  for (const FrontierPoint& point : frontier_methods(scene)) {
    EXPECT_THAT(labels, ::testing::Not(Contains(point.label)));
    labels.push_back(point.label);
    EXPECT_FALSE(point.is_reference);
    if (point.method.is_current) {
      current.push_back(point.label);
    }
  }
  EXPECT_THAT(current, ::testing::ElementsAre("8 samples"));
  for (const char* label : {"1 sample",
                            "1024 samples",
                            "8 samples, 1 reflection",
                            "8 samples, 4 reflections",
                            "4 samples, half resolution",
                            "8 samples, 1/4 resolution",
                            "direct sum, 4 rays",
                            "direct sum, 1 ray, half resolution",
                            "8 samples, facets 20 um",
                            "8 samples, defects displaced"}) {
    EXPECT_THAT(labels, Contains(label));
  }
}

/// Measured once for all tests, with time enough for everything.
const Frontier& ring_frontier() {
  static const Frontier frontier = [] {
    SceneSettings scene = ring_scene();
    scene.defects.front().second.x_mm = {3.0, 20.0};
    scene.defects.front().second.y_mm = {2.0, 16.0};
    return measure_path_frontier(scene, {.threads = 2});
  }();
  return frontier;
}

TEST(PathFrontier, ErrorsFallWithTheRootOfTheSamples) {
  const double at_4 = *point_named(ring_frontier(), "4 samples").frame_rmse;
  const double at_64 = *point_named(ring_frontier(), "64 samples").frame_rmse;
  EXPECT_GT(at_4, 0.001);
  EXPECT_GT(at_4 / at_64, 2.5) << "independent samples give 4, stratified ones more";
  EXPECT_LT(*ring_frontier().reference.own_frame_rmse, at_64);
  EXPECT_LT(point_named(ring_frontier(), "64 samples").h_error_points,
            point_named(ring_frontier(), "1 sample").h_error_points);
}

TEST(PathFrontier, MarksTheAutomaticChoiceOnItsDrawing) {
  Frontier frontier = ring_frontier();
  const auto with = [&] { return frontier_svg(frontier, "title"); };
  EXPECT_THAT(with(), testing::Not(testing::HasSubstr("the automatic choice")));
  const AccuracySettings any = {.wishes = {{.score = "homogeneity.h_rms", .tolerance = 1.0}}};
  mark_choice(render_ladder(ring_scene(), {}), any, frontier);
  EXPECT_THAT(with(), testing::HasSubstr("the automatic choice"));
}

TEST(PathFrontier, TellsItsReferenceAndWhatIsOutOfSight) {
  const Frontier& frontier = ring_frontier();
  EXPECT_EQ(frontier.pixel_factor, 1);
  EXPECT_EQ(frontier.reference.pictures, 4);
  EXPECT_GE(frontier.reference.method.paths.samples, 16);
  EXPECT_EQ(frontier.reference.method.paths.max_reflections, 8);
  EXPECT_GT(frontier.reference.scores.at("homogeneity.h_rms").standard_error, 0.0);
  EXPECT_THAT(frontier.unseen, ::testing::ElementsAre("dent_2"));
  for (const FrontierPoint& point : frontier.points) {
    if (point.problem.empty()) {
      EXPECT_GT(point.cpu_s, 0.0) << point.label;
      EXPECT_GT(point.rays, 0) << point.label;
      EXPECT_TRUE(point.defects.size() == 1U || point.reduction > 1) << point.label;
      EXPECT_TRUE(point.scores.contains("homogeneity.h_rms")) << point.label;
    }
  }
  EXPECT_EQ(point_named(frontier, "4 samples").problem, "");
  EXPECT_GT(point_named(frontier, "4 samples").pictures, 1);
}

TEST(PathFrontier, SumsOfDirectLightErrLessThanPathsOfAsMuchTime) {
  const FrontierPoint& sum = point_named(ring_frontier(), "direct sum, 4 rays");
  ASSERT_EQ(sum.problem, "");
  EXPECT_EQ(sum.pictures, 1) << "it has no noise";
  EXPECT_GT(sum.rays, 0);
  EXPECT_LT(*sum.frame_rmse, *point_named(ring_frontier(), "64 samples").frame_rmse);
}

TEST(PathFrontier, NamesWhatTheBudgetLeavesOut) {
  const Frontier frontier = measure_path_frontier(ring_scene(), {.budget_s = 0.05});
  EXPECT_THAT(point_named(frontier, "1024 samples").problem, HasSubstr("of the budget are left"));
}

TEST(PathFrontier, IsDrawnWithTheScenesOwnSetting) {
  const std::string svg = frontier_svg(ring_frontier(), "ring");
  EXPECT_THAT(svg, HasSubstr("the scene's own setting"));
  EXPECT_THAT(svg, HasSubstr("one more picture"));
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(RankDesigns, OrdersThemAsADearerMethodDoes) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", kRingStudy + R"(
[variables]
"lighting.ring.height_mm" = { min = 40, max = 160 }
"lighting.ring.radiance.0" = { min = 1, max = 4 }
[objective]
maximise = "homogeneity.h_rms"
)");
  const Study study = load_study(folder / "study.toml", {});
  Frontier frontier = ring_frontier();
  std::erase_if(frontier.points,
                [](const FrontierPoint& point) { return point.method.paths.samples > 64; });
  const auto ranking = rank_designs(study, frontier, {.threads = 2, .budget_s = 600.0});
  ASSERT_TRUE(ranking);
  EXPECT_EQ(ranking->score, "homogeneity.h_rms");
  EXPECT_EQ(ranking->designs, 12);
  EXPECT_EQ(ranking->reference, "64 samples");
  EXPECT_GT(ranking->mean_error, 0.0);
  const auto row = std::ranges::find(ranking->methods, "16 samples", &MethodRanking::label);
  ASSERT_NE(row, ranking->methods.end());
  EXPECT_GT(row->agreement.pairs, 5U);
  EXPECT_GT(row->agreement.tau, 0.5) << "without any agreement about 0 +- 0.2";
  EXPECT_FALSE(rank_designs(load_study(folder / "study.toml", {{"variables", "{}"}}), frontier, {}))
      << "without variables there are no designs";
  const Study limited =
      load_study(folder / "study.toml", {{"constraints", "{\"homogeneity.mean\" = {max = 0.01}}"}});
  const auto by_merit = rank_designs(limited, frontier, {.threads = 2, .budget_s = 600.0});
  ASSERT_TRUE(by_merit);
  EXPECT_GT(by_merit->mean_error, ranking->mean_error) << "the noise of the penalty";
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/rng.h"
#include "studies/definition/ladder/larger_pixels.h"
#include "studies/evaluation/evaluation.h"
#include "studies/frontier/banded_scan.h"
#include "studies/frontier/frontier_drawing.h"
#include "studies/frontier/frontier_errors.h"
#include "studies/frontier/frontier_methods.h"
#include "studies/frontier/frontier_page.h"
#include "tests/studies/scene_from.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

constexpr const char* kFrontierStudy = R"(
schema = 1
title = "Small & plain"
[part]
length_mm = 60
width_mm = 30
radius_along_mm = 300
radius_across_mm = 40
[camera]
width_px = 101
height_px = 61
object_pixel_mm = 0.6
working_distance_mm = 300
[sensor]
gain = 1.5
blur_px = 0.6
full_well_e = 10000
[scan]
positions = 8
[render]
method = "sampled"
[lighting.tunnel]
radius_mm = 120
slot_mm = 24
[defects.dent]
x_mm = [-12, 12]
y_mm = [8, -8]
height_um = 8
diameter_mm = 3
)";

SceneSettings frontier_scene() {
  return test::scene_from(kFrontierStudy);
}

/// The same without what bands do not have: noise.
SceneSettings noiseless_scene() {
  SceneSettings scene = frontier_scene();
  scene.sensor.full_well_e = 0.0;
  scene.sensor.bits = 0;
  return scene;
}

FrontierPoint timed_point(double cpu_s, double rmse) {
  FrontierPoint point;
  point.cpu_s = cpu_s;
  point.frame_rmse = rmse;
  return point;
}

bool is_on_frame_front(const FrontierPoint& point) {
  return std::ranges::count(point.on_front, kFrameRmse) == 1;
}

TEST(BandedScan, GivesTheScoresOfTheSceneAtOnce) {
  const SceneSettings scene = noiseless_scene();
  ThreadPool pool(2);
  SceneStore store(pool);
  const Evaluation whole = evaluate(store, scene);
  const auto traced = store.trace(scene);
  // 101 pixels x 4 rays: bands of 4 rows, and one that is a single row.
  const ScoredScan banded = evaluate_in_bands(*traced->part, scene, pool, {.max_rays = 1700});
  EXPECT_NEAR(banded.h_rms, whole.scores.at("homogeneity.h_rms"), 1e-5);
  ASSERT_EQ(banded.defects.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(banded.defects[i].label, whole.defects[i].label);
    EXPECT_NEAR(banded.defects[i].weber, whole.defects[i].weber, 1e-4);
    EXPECT_NEAR(banded.defects[i].change, whole.defects[i].change, 1e-4);
    EXPECT_NEAR(banded.defects[i].best_frame, whole.defects[i].best_frame, 1e-4);
    EXPECT_GT(whole.defects[i].change, 0.01) << "else nothing is compared";
  }
  EXPECT_GT(banded.cpu_s, 0.0);
  EXPECT_GE(banded.cold_cpu_s, banded.cpu_s);
}

TEST(BandedScan, DoesNotDependOnTheHeightOfABand) {
  const SceneSettings scene = noiseless_scene();
  ThreadPool pool(2);
  SceneStore store(pool);
  const auto traced = store.trace(scene);
  const PinholeIntrinsics camera = intrinsics_of(scene.camera);
  const auto scan = [&](std::int64_t max_rays) {
    return scan_in_bands(
        traced->built(), traced->detail(), camera, scene, pool, {.max_rays = max_rays});
  };
  const BandedScan rows = scan(1);
  const BandedScan whole = scan(1 << 22);
  EXPECT_EQ(rows.seen.coverage, whole.seen.coverage);
  EXPECT_EQ(rows.lit, whole.lit);
  EXPECT_EQ(rows.lit(0, 0), 0) << "the corner does not see the part";
  EXPECT_EQ(rows.seen.counts.camera, 101 * 61 * 4);
  EXPECT_EQ(rows.seen.counts.part, whole.seen.counts.part);
  ASSERT_EQ(rows.radiance.size(), 8U);
  int different = 0;
  for (std::size_t k = 0; k < 8; ++k) {
    for (std::size_t i = 0; i < rows.radiance[k].size(); ++i) {
      different += rows.radiance[k].values()[i] != whole.radiance[k].values()[i] ? 1 : 0;
    }
  }
  // The principal point moves by whole pixels: single rays may round to the other side of an edge.
  EXPECT_LE(different, 10);
}

// The corner of the half picture's pixel (i, j) is the corner of the full one's (2 i, 2 j).
TEST(WithLargerPixels, SeesTheSameThroughPixelsOfTwiceTheSize) {
  SceneSettings scene = frontier_scene();
  scene.camera.k1 = 0.05;
  const SceneSettings half = with_larger_pixels(scene, 2);
  EXPECT_EQ(half.camera.width_px, 50);
  EXPECT_EQ(half.camera.height_px, 30);
  EXPECT_DOUBLE_EQ(half.sensor.blur_px, 0.3);
  const PinholeCamera full_camera(intrinsics_of(scene.camera));
  const PinholeCamera half_camera(intrinsics_of(half.camera));
  Rng rng(7, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d place(50.0 * rng.uniform(), 30.0 * rng.uniform());
    EXPECT_LT((*half_camera.ray_through(place) - *full_camera.ray_through(2.0 * place)).norm(),
              1e-12);
  }
}

// Linear interpolation gives a plane back exactly, but for the rim, which has no neighbour.
TEST(Enlarged, KeepsPlanes) {
  Rng rng(8, Stream::kTest, 0);
  for (int trial = 0; trial < 50; ++trial) {
    const double a = rng.uniform();
    const double b = rng.uniform();
    ImageF half(7, 6);
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 7; ++x) {
        half(x, y) = static_cast<float>(a * (2.0 * x + 1.0) + b * (2.0 * y + 1.0));
      }
    }
    const ImageF full = enlarged(half, 15, 13);
    for (int y = 1; y < 11; ++y) {
      for (int x = 1; x < 13; ++x) {
        ASSERT_NEAR(full(x, y), a * (x + 0.5) + b * (y + 0.5), 1e-5);
      }
    }
    EXPECT_EQ(full(0, 0), half(0, 0));
    EXPECT_EQ(full(14, 12), half(6, 5));
  }
}

// own = 1, k = 2: rmse_16 = sqrt(1 + 16) = 4.1231, rmse_64 = sqrt(1 + 4) = 2.2361.
TEST(OwnFrameRmse, IsWhatTwoDistancesSay) {
  EXPECT_NEAR(own_frame_rmse(std::sqrt(17.0), std::sqrt(5.0)).value(), 1.0, 1e-12);
  EXPECT_FALSE(own_frame_rmse(0.0, 0.0));
  EXPECT_FALSE(own_frame_rmse(1.0, 1.0));
}

TEST(Front, OfAHandWorkedSet) {
  std::vector<FrontierPoint> points = {timed_point(1, 5),
                                       timed_point(2, 3),
                                       timed_point(3, 4),
                                       timed_point(4, 1),
                                       timed_point(2, 6)};
  points.push_back(timed_point(0.5, 0.0));
  points.back().is_reference = true;
  points.push_back(timed_point(0.1, 0.1));
  points.back().problem = "could not be measured";
  mark_front(points);
  const std::vector<bool> expected = {true, true, false, true, false, false, false};
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(is_on_frame_front(points[i]), expected[i]) << i;
  }
}

TEST(Front, BeatsEveryPointThatIsNotOnIt) {
  Rng rng(9, Stream::kTest, 0);
  for (int trial = 0; trial < 1000; ++trial) {
    std::vector<FrontierPoint> points;
    for (int i = 0; i < 12; ++i) {
      // Few values, so that ties occur.
      points.push_back(
          timed_point(1.0 + std::floor(6.0 * rng.uniform()), std::floor(6.0 * rng.uniform())));
    }
    mark_front(points);
    for (const FrontierPoint& point : points) {
      const bool is_beaten = std::ranges::any_of(points, [&](const FrontierPoint& other) {
        return is_on_frame_front(other) && other.cpu_s <= point.cpu_s &&
               *other.frame_rmse <= *point.frame_rmse &&
               (other.cpu_s < point.cpu_s || *other.frame_rmse < *point.frame_rmse);
      });
      ASSERT_NE(is_on_frame_front(point), is_beaten);
    }
  }
}

TEST(FrontierMethods, AreDistinctAndHaveOneReference) {
  SceneSettings scene = frontier_scene();
  std::set<std::string> labels;
  int references = 0;
  int faceted = 0;
  for (const FrontierPoint& point : frontier_methods(scene)) {
    EXPECT_TRUE(labels.insert(point.label).second) << point.label;
    references += point.is_reference ? 1 : 0;
    faceted += point.tessellation == "exact surface" ? 0 : 1;
  }
  EXPECT_EQ(references, 1);
  EXPECT_EQ(faceted, 6);
  scene.part.shape = PartSettings::Shape::kMesh;
  for (const FrontierPoint& point : frontier_methods(scene)) {
    EXPECT_EQ(point.tessellation, "mesh file");
  }
}

/// The frontier of the small scene, measured once for all tests.
const Frontier& small_frontier() {
  static const Frontier frontier = measure_frontier(frontier_scene(), {.repeats = 1});
  return frontier;
}

const FrontierPoint& plain_point(int rays_per_px) {
  for (const FrontierPoint& point : small_frontier().points) {
    if (point.method.rays_per_px == rays_per_px) {
      return point;  // full resolution comes first
    }
  }
  throw std::logic_error("there is no such point");
}

TEST(Frontier, PlainSamplingGetsBetterWithMoreRays) {
  double before = 1.0;
  for (const int rays : {1, 4, 16, 64}) {
    const FrontierPoint& point = plain_point(rays);
    EXPECT_LT(*point.frame_rmse, 0.7 * before) << rays;
    EXPECT_GT(*point.frame_rmse, 0.0);
    before = *point.frame_rmse;
  }
  EXPECT_LT(plain_point(64).h_error_points, 0.2);
  EXPECT_LT(*plain_point(64).contrast_error_percent(), 20.0);
  EXPECT_EQ(*plain_point(256).frame_rmse, 0.0);
  EXPECT_LT(*small_frontier().reference.own_frame_rmse, *plain_point(64).frame_rmse);
}

TEST(Frontier, MeasuresEveryMethod) {
  const Frontier& frontier = small_frontier();
  EXPECT_EQ(frontier.reference.weber.size(), 2U);
  int choices = 0;
  for (const FrontierPoint& point : frontier.points) {
    EXPECT_EQ(point.problem, "") << point.label;
    EXPECT_GT(point.cpu_s, 0.0) << point.label;
    EXPECT_GT(point.cold_s, 0.0) << point.label;
    EXPECT_EQ(point.frame_rmse.has_value(), point.method.has_frames) << point.label;
    EXPECT_EQ(point.smooth_frame_rmse.has_value(), point.method.has_frames) << point.label;
    EXPECT_NE(point.form, "") << point.label;
    EXPECT_GT(point.traced_per_px, 0.9) << point.label;
    EXPECT_EQ(point.defects.size(), 2U) << point.label;
    EXPECT_TRUE(point.is_reference || point.h_error_points > 0.0) << point.label;
    if (!point.is_reference) {
      EXPECT_NEAR(100.0 * point.scores.at("homogeneity.h_rms").error, point.h_error_points, 1e-9);
      EXPECT_TRUE(point.scores.contains("homogeneity.mean")) << point.label;
      EXPECT_TRUE(point.scores.contains("defects.min_cnr")) << point.label;
    }
    choices += point.method.is_choice ? 1 : 0;
  }
  EXPECT_EQ(choices, 2);
}

// The chart is about them: what the scene has now, and what the program does by itself.
TEST(Frontier, MeasuresTheScenesOwnMethodsHoweverLittleTimeThereIs) {
  const Frontier frontier = measure_frontier(frontier_scene(), {.repeats = 1, .budget_s = 1e-9});
  int left_out = 0;
  for (const FrontierPoint& point : frontier.points) {
    const bool is_own = point.method.is_current || point.method.is_choice;
    EXPECT_TRUE(point.problem.empty() || !is_own) << point.label;
    left_out += point.problem.empty() ? 0 : 1;
  }
  EXPECT_GT(left_out, 5);
}

TEST(FrontierSvg, IsTheSameBytesAndEscapesTheTitle) {
  const std::string svg = frontier_svg(small_frontier(), "a < b & c");
  EXPECT_EQ(svg, frontier_svg(small_frontier(), "a < b & c"));
  EXPECT_THAT(svg, HasSubstr("a &lt; b &amp; c"));
  EXPECT_THAT(svg, HasSubstr("plain sampling, half resolution"));
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_THAT(frontier_svg({}, "empty"), HasSubstr("</svg>")) << "nothing measured, nothing drawn";
}

TEST(FrontierStudy, WritesItsFilesAndLeavesARunsFilesAlone) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", kFrontierStudy);
  const Study study = load_study(folder / "study.toml",
                                 {{"camera.width_px", "51"},
                                  {"camera.height_px", "31"},
                                  {"camera.object_pixel_mm", "1.2"},
                                  {"scan.positions", "4"}});
  write_file(folder / "run.json", "{}");
  const FrontierRun run = {.out = folder.path(), .progress = Progress::Style::kNone};
  EXPECT_THROW(frontier_study(study, run), ConfigError) << "whose run.json is not known";
  write_file(folder / "study.sqlite", "");  // a search's folder
  const auto json = frontier_study(study, run);
  EXPECT_EQ(json["report"], (folder / "frontier.html").string());
  EXPECT_EQ(read_file(folder / "run.json"), "{}");
  auto written = nlohmann::ordered_json::parse(read_file(folder / "frontier.json"));
  EXPECT_EQ(written["report"], "frontier.html");
  EXPECT_EQ(written["points"], json["points"]);
  const auto& first = written["points"][0];
  EXPECT_EQ(first["method"], "sampled");
  EXPECT_EQ(first["kind"], 0);
  EXPECT_EQ(first["kind_name"], "plain sampling");
  EXPECT_EQ(first["is_noisy"], false);
  EXPECT_EQ(written["reference"]["is_noisy"], false);
  EXPECT_EQ(first["rays_per_px"], 1);
  EXPECT_EQ(first["resolution"], "full");
  EXPECT_TRUE(first["defects"]["dent_1"].contains("weber_error_percent"));
  EXPECT_TRUE(first["defects"]["dent_1"].contains("change_error_percent"));
  EXPECT_THAT(read_file(folder / "frontier.html"), HasSubstr("\"frontier\":{\"schema\":1"));
  EXPECT_THAT(read_file(folder / "frontier.html"), HasSubstr("It is no rung of [accuracy]"));
}

}  // namespace
}  // namespace glint

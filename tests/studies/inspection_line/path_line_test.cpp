// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/path_line.h"

#include <cmath>

#include <gtest/gtest.h>

#include "studies/evaluation/evaluation.h"
#include "studies/inspection_line/simulated_line.h"
#include "studies/inspection_line/visibility.h"
#include "tests/studies/inspection_line/visibility_support.h"

namespace glint {
namespace {

/// A rough strip with two dents under a ring light.
SceneSettings ring_line(double depth_um) {
  SceneSettings scene = small_line(depth_um, depth_um);
  scene.camera.width_px = 120;
  scene.camera.height_px = 72;
  scene.viewpoint() = default_viewpoint(scene.camera);
  scene.has_tunnel = false;
  scene.material.type = MaterialSettings::Type::kConductor;
  scene.material.reflectance = {0.8};
  scene.material.alpha = {0.2};
  RingSettings ring;
  ring.placement.position_mm = {0.0, 0.0, 60.0};
  ring.inner_radius_mm = 60.0;
  ring.outer_radius_mm = 75.0;
  ring.emission.radiance = {12.0};
  scene.lights = {{.name = "ring", .settings = ring}};
  scene.sensor.gain = 1.0;
  scene.paths.samples = 32;
  DefectGroup& dents = scene.defects[0].second;
  dents.count = 2;
  dents.realisation = Realisation::kNormal;
  dents.diameter_mm = Interval(1.0, 1.0);
  dents.region.min_mm = {-7.0, -3.5, -10.0};
  dents.region.max_mm = {7.0, 3.5, 20.0};
  scene.inspection.trials.parts = 8;
  scene.inspection.trials.flawless = 12;
  return scene;
}

/// The same under a dome, which is as bright from nearly everywhere.
SceneSettings dome_line(double depth_um) {
  SceneSettings scene = ring_line(depth_um);
  DomeSettings dome;
  dome.placement.position_mm = {0.0, 0.0, 0.0};
  dome.radius_mm = 150.0;
  dome.opening_mm = 20.0;
  dome.emission.radiance = {0.7};
  scene.lights = {{.name = "dome", .settings = dome}};
  return scene;
}

int found_on(const SimulatedLine& line, int parts) {
  const double threshold = line.threshold();
  int found = 0;
  for (int number = 0; number < parts; ++number) {
    const ScannedPart part = line.part(number);
    found += match_detections(line.inspect(part, threshold), part.defects, {}).found();
  }
  return found;
}

/// A flawless part in colour.
/// @param red, others  radiance of the ring in the channels
SceneSettings colour_line(double red, double others) {
  SceneSettings scene = ring_line(0.0);
  scene.defects.clear();
  scene.sensor.wavelengths_nm = {630.0, 532.0, 465.0};
  scene.sensor.full_well_e = 2000.0;
  std::get<RingSettings>(scene.lights[0].settings).emission.radiance = {red, others, others};
  scene.paths.samples = 64;
  return scene;
}

/// Mean and standard deviation over the scored region.
struct Spread {
  double mean = 0.0;
  double deviation = 0.0;
};

Spread spread_of(const ImageF& image, const Mask& region) {
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (region.values()[i] != 0) {
      const auto value = static_cast<double>(image.values()[i]);
      sum += value;
      squares += value * value;
      count += 1.0;
    }
  }
  return {.mean = sum / count,
          .deviation = std::sqrt(squares / count - sum * sum / (count * count))};
}

ImageF difference(const ImageF& a, const ImageF& b) {
  ImageF image = a;
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.values()[i] -= b.values()[i];
  }
  return image;
}

// Each channel clips and has noise by itself: of a mean of three channels alike the noise is less
// than that of one by the root of 3.
TEST(PathLine, ClipsAndHasNoiseAsTheScoresOfAColourSensor) {
  ThreadPool pool(2);
  SceneStore store(pool);
  // Red light that brings the part to full scale on average, the others to a third of it.
  constexpr double kDim = 0.5;
  const double grey = evaluate(store, colour_line(kDim, kDim)).scores.at("homogeneity.mean");
  ASSERT_GT(grey, 0.0);
  ASSERT_LT(grey, 0.5);
  const SceneSettings scene = colour_line(kDim / grey, kDim / (3.0 * grey));
  const Evaluation scored = evaluate(store, scene);
  const Mask& region = scored.traced->region.mask;
  EXPECT_GT(scored.scores.at("homogeneity.clipped_share"), 0.1) << "else nothing is clipped";
  EXPECT_LT(scored.scores.at("homogeneity.clipped_share"), 0.9) << "else red has no noise";
  const auto line = path_line(scene, scored.traced, store);
  const double expected = spread_of(line->expected().quiet.aspect, region).mean;
  EXPECT_NEAR(expected, spread_of(scored.aspect, region).mean, 0.005);
  SceneSettings other = scene;
  other.sensor.seed = scene.sensor.seed + 1;
  const ImageF noise = difference(evaluate(store, other).aspect, scored.aspect);
  const ImageF of_line =
      difference(line->flawless(other.sensor).aspect, line->flawless(scene.sensor).aspect);
  const double of_scores = spread_of(noise, region).deviation;
  EXPECT_NEAR(spread_of(of_line, region).deviation, of_scores, 0.05 * of_scores);
}

TEST(PathLine, FindsDeepDentsUnderARing) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SimulatedLine line(store, ring_line(60.0));
  EXPECT_GT(line.region_share(), 0.9);
  EXPECT_EQ(found_on(line, 5), 10);
}

TEST(PathLine, SeesLessUnderADomeAllRound) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const std::vector<std::string> names = {"inspection.dprime", "inspection.auc"};
  const Scores ring = visibility_scores(store, ring_line(40.0), names);
  const Scores dome = visibility_scores(store, dome_line(40.0), names);
  EXPECT_GT(ring.at("inspection.dprime"), 10.0);
  EXPECT_LT(dome.at("inspection.dprime"), 0.5 * ring.at("inspection.dprime"));
  EXPECT_LT(dome.at("inspection.auc"), ring.at("inspection.auc"));
}

// The threshold that 200 flawless scans give 0.5 blobs each; 200 others have 100 blobs, and both
// numbers scatter by 10: within four deviations of their difference.
TEST(PathLine, HasTheFalseAlarmsThatWereAskedFor) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = ring_line(12.0);
  scene.inspection.trials.flawless = 200;
  scene.inspection.false_alarms_per_picture = 0.5;
  const std::vector<std::string> names = {"inspection.false_alarms"};
  const Scores scores = visibility_scores(store, scene, names);
  EXPECT_NEAR(scores.at("inspection.false_alarms"), 0.5, 4.0 * std::sqrt(2.0) * 0.05);
}

TEST(PathLine, GivesTheSameBytesForAnyNumberOfThreads) {
  std::vector<ImageF> responses;
  for (const int threads : {1, 2, 7}) {
    ThreadPool pool(threads);
    SceneStore store(pool);
    const SimulatedLine line(store, ring_line(12.0));
    const auto parts =
        pool.map<ImageF>(3, [&](std::int64_t number) { return line.part(number).response; });
    responses.insert(responses.end(), parts.begin(), parts.end());
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(responses[i], responses[3 + i]) << i;
    EXPECT_EQ(responses[i], responses[6 + i]) << i;
  }
}

// Height 0 leaves every ray as it is: the windows are rendered, and add nothing at all.
TEST(PathLine, AddsNothingWhereDefectsChangeNothing) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = ring_line(12.0);
  scene.sensor.full_well_e = scene.sensor.read_noise_e = 0.0;
  const SimulatedLine line(store, scene);
  std::vector<NamedGroup> flat = scene.defects;
  flat[0].second.height_mm = 1e-12;
  const ScannedPart part = line.part_with(flat, 3);
  ASSERT_EQ(part.defects.size(), 2U);
  EXPECT_EQ(part.aspect, line.flawless(0).aspect);
  EXPECT_NE(line.part(3).aspect, part.aspect);
}

// Outside the windows a part's scan is the flawless one of the same noise, and in them it differs
// only where the defects reach: 2.5 radii of 0.5 mm, a pixel of margin and the sensor's blur.
TEST(PathLine, ChangesNothingAwayFromTheDefects) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = ring_line(25.0);
  scene.sensor.full_well_e = scene.sensor.read_noise_e = 0.0;
  scene.sensor.blur_px = 0.0;
  const SimulatedLine line(store, scene);
  const ImageF flawless = line.flawless(0).aspect;
  const ScannedPart part = line.part(1);
  int changed = 0;
  for (int y = 0; y < flawless.height(); ++y) {
    for (int x = 0; x < flawless.width(); ++x) {
      float nearest = DefectView::kFar;
      for (const TrueDefect& defect : part.defects) {
        const int u = x - defect.view.left_px;
        const int v = y - defect.view.top_px;
        if (u >= 0 && v >= 0 && u < defect.view.distance.width() &&
            v < defect.view.distance.height()) {
          nearest = std::min(nearest, defect.view.distance(u, v));
        }
      }
      const bool is_changed = part.aspect(x, y) != flawless(x, y);
      changed += is_changed ? 1 : 0;
      EXPECT_TRUE(!is_changed || nearest < 2.5F + 2.0F * 0.15F / 0.5F) << x << " " << y;
    }
  }
  EXPECT_GT(changed, 50);
}

// The same light from everywhere: a dent changes next to nothing, but each of its few samples is
// another one. A chance hit near a defect is possible, a tenth of a blob a part is asked for.
TEST(PathLine, TakesNoNoiseOfRenderingForADefect) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = ring_line(40.0);
  EnvironmentSettings sky;
  sky.radiance = {0.6};
  scene.lights = {{.name = "sky", .settings = sky}};
  scene.paths.samples = 8;
  const std::vector<std::string> names = {"inspection.rendering_error", "inspection.dprime"};
  EXPECT_LE(found_on(SimulatedLine(store, scene), 10), 1);
  EXPECT_LT(visibility_scores(store, scene, names).at("inspection.dprime"), 2.5);
}

// Pictures are linear in the powers of lights.
TEST(PathLine, RendersOnceForAllPowers) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = ring_line(12.0);
  const SimulatedLine first(store, scene);
  const ScannedPart part = first.part(0);
  EXPECT_EQ(store.lines().flawless.num_made(), 1);
  EXPECT_EQ(store.lines().changes.num_made(), 1);
  std::get<RingSettings>(scene.lights[0].settings).emission.radiance = {9.0};
  const SimulatedLine dimmer(store, scene);
  const ScannedPart again = dimmer.part(0);
  EXPECT_EQ(store.lines().flawless.num_made(), 1);
  EXPECT_EQ(store.lines().changes.num_made(), 1);
  SceneStore other_store(pool);
  const SimulatedLine fresh(other_store, scene);
  EXPECT_EQ(fresh.part(0).aspect, again.aspect);
  EXPECT_NE(part.aspect, again.aspect);
  dimmer.part(1);
  EXPECT_EQ(store.lines().changes.num_made(), 2);
}

// A mirror under a tunnel, all frames by path tracing: what level 0 gives.
TEST(PathLine, AgreesWithLevel0OnAMirrorUnderATunnel) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = small_line(4.0, 4.0);
  scene.camera.width_px = 120;
  scene.camera.height_px = 72;
  scene.viewpoint() = default_viewpoint(scene.camera);
  scene.inspection.threshold = InspectionSettings::Threshold::kFixed;
  const SimulatedLine level0(store, scene);
  scene.render.method = RenderSettings::Method::kPaths;
  scene.paths.samples = 16;
  const SimulatedLine paths(store, scene);
  double sum = 0.0;
  for (std::size_t i = 0; i < level0.expected_aspect().size(); ++i) {
    sum += static_cast<double>(level0.region().values()[i]) *
           std::abs(static_cast<double>(level0.expected_aspect().values()[i]) -
                    static_cast<double>(paths.expected_aspect().values()[i]));
  }
  EXPECT_LT(sum / static_cast<double>(count_inside(level0.region())), 0.01);
  EXPECT_EQ(found_on(paths, 2), found_on(level0, 2));
}

// Without smoothing 32 samples would be most of what a flawless part answers.
TEST(PathLine, KeepsTheNoiseOfRenderingSmall) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = ring_line(12.0);
  const SimulatedLine line(store, scene);
  EXPECT_GT(line.rendering_share(), 0.0);
  EXPECT_LT(line.rendering_share(), 0.1);
  const std::vector<std::string> names = {"inspection.rendering_error",
                                          "inspection.rendering_share"};
  const Scores scores = visibility_scores(store, scene, names);
  EXPECT_EQ(scores.at("inspection.rendering_share"), line.rendering_share());
  EXPECT_GT(scores.at("inspection.rendering_error"), 0.0);
  EXPECT_LT(scores.at("inspection.rendering_error"), 0.1);
}

}  // namespace
}  // namespace glint

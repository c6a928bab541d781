// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspection_line/simulated_line.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/metrics/aspect_image/disc_view.h"
#include "tests/studies/inspection_line/visibility_support.h"

namespace glint {
namespace {

/// Dents of 4 um, which are found.
SceneSettings line_scene() {
  SceneSettings scene = small_line(4.0, 4.0);
  scene.inspection.threshold = InspectionSettings::Threshold::kNoise;
  return scene;
}

FoundDefect blob_at(double x_px, double y_px) {
  FoundDefect blob;
  blob.x_px = x_px;
  blob.y_px = y_px;
  return blob;
}

TrueDefect disc_at(double x_px, double y_px, double radius_px) {
  TrueDefect defect;
  defect.view = disc_view("dent", x_px, y_px, radius_px, 100, 100);
  return defect;
}

TEST(MatchDetections, GivesEachBlobToTheNearestDefectAndCountsTheRest) {
  const std::vector<TrueDefect> truth = {
      disc_at(20, 20, 4), disc_at(30, 20, 4), disc_at(70, 70, 2)};
  // 1 px from the first; 3 px from the second; 20 px from any. The third is not found.
  const std::vector<FoundDefect> found = {blob_at(21, 20), blob_at(27, 20), blob_at(50, 50)};
  const DetectionMatches matches = match_detections(found, truth, {});
  EXPECT_EQ(matches.blob_of_defect, (std::vector<int>{0, 1, -1}));
  EXPECT_EQ(matches.defect_of_blob, (std::vector<int>{0, 1, -1}));
  EXPECT_EQ(matches.false_alarms(), 1);
}

// 1.5 radii of 4 px are 6 px, and 1.5 px more are allowed for the blob's own place.
TEST(MatchDetections, ReachesAsFarAsAsked) {
  const std::vector<TrueDefect> truth = {disc_at(20.5, 20.5, 4)};
  const TrialSettings settings = {.hit_radii = 1.5, .echo_px = 10.0};
  const auto is_found = [&](double x_px) {
    return match_detections(std::vector{blob_at(x_px, 20.5)}, truth, settings).is_found(0);
  };
  const auto false_alarms = [&](double x_px) {
    return match_detections(std::vector{blob_at(x_px, 20.5)}, truth, settings).false_alarms();
  };
  EXPECT_TRUE(is_found(27.4));
  EXPECT_FALSE(is_found(28.6));
  EXPECT_EQ(false_alarms(28.6), 0);  // a side lobe, up to 17.5 px away
  EXPECT_EQ(false_alarms(37.4), 0);
  EXPECT_EQ(false_alarms(38.6), 1);
}

TEST(MatchDetections, CountsMaskedDefectsAsMissedAndTheirBlobsAsNoFalseAlarm) {
  std::vector<TrueDefect> truth = {disc_at(20, 20, 4)};
  truth[0].is_masked = true;
  const DetectionMatches matches = match_detections(std::vector{blob_at(20, 20)}, truth, {});
  EXPECT_FALSE(matches.is_found(0));
  EXPECT_EQ(matches.defect_of_blob, std::vector<int>{0});
  EXPECT_EQ(matches.false_alarms(), 0);
}

TEST(SimulatedLine, ShowsEveryLightingTheSamePartsAndNoise) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = line_scene();
  SceneSettings other = scene;
  other.tunnel.period_mm = 2.0 * scene.tunnel.period_mm;
  const SimulatedLine first(store, scene);
  const SimulatedLine second(store, other);
  for (int number = 0; number < 3; ++number) {
    const ScannedPart a = first.part(number);
    const ScannedPart b = second.part(number);
    ASSERT_EQ(a.defects.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(a.defects[i].outline.centre_mm, b.defects[i].outline.centre_mm);
      EXPECT_EQ(a.defects[i].outline.sigma_mm, b.defects[i].outline.sigma_mm);
    }
    EXPECT_EQ(first.part(number).aspect, a.aspect);
    EXPECT_NE(first.part(number + 1).aspect, a.aspect);
    EXPECT_NE(b.aspect, a.aspect);
  }
}

TEST(SimulatedLine, GivesTheSameBytesForAnyNumberOfThreads) {
  std::vector<ImageF> responses;
  for (const int threads : {1, 2, 7}) {
    ThreadPool pool(threads);
    SceneStore store(pool);
    const SimulatedLine line(store, line_scene());
    const auto parts =
        pool.map<ImageF>(4, [&](std::int64_t number) { return line.part(number).response; });
    responses.insert(responses.end(), parts.begin(), parts.end());
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(responses[i], responses[4 + i]) << i;
    EXPECT_EQ(responses[i], responses[8 + i]) << i;
  }
}

struct Moments {
  double mean = 0.0;
  double noise_variance = 0.0;  ///< root of the mean variance
};

/// Of the mean image over some flawless scans.
Moments moments_of(const SimulatedLine& line, int scans) {
  const Mask& region = line.region();
  std::vector<double> sum(region.size());
  std::vector<double> squares(region.size());
  for (int k = 0; k < scans; ++k) {
    const ImageF aspect = line.flawless(k).aspect;
    for (std::size_t i = 0; i < region.size(); ++i) {
      const auto value = static_cast<double>(aspect.values()[i]);
      sum[i] += value;
      squares[i] += value * value;
    }
  }
  Moments moments;
  double count = 0.0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region.values()[i] != 0) {
      const double mean = sum[i] / scans;
      moments.mean += mean;
      moments.noise_variance += (squares[i] - scans * mean * mean) / (scans - 1);
      count += 1.0;
    }
  }
  moments.mean /= count;
  moments.noise_variance = std::sqrt(moments.noise_variance / count);
  return moments;
}

// Closed forms draw the mean's noise at once, frames draw that of each frame. With 30 scans of
// 10,000 pixels the scatter is known to 0.2 %.
TEST(SimulatedLine, ScattersLikeFullSequencesDo) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = line_scene();
  const Moments closed = moments_of(SimulatedLine(store, scene), 30);
  scene.render.method = RenderSettings::Method::kIntegrated;
  const Moments frames = moments_of(SimulatedLine(store, scene), 30);
  EXPECT_NEAR(closed.mean, frames.mean, 1e-4);
  EXPECT_NEAR(closed.noise_variance / frames.noise_variance, 1.0, 0.02);
}

// Without noise nothing is drawn: rendering what the defects change gives the whole picture.
TEST(SimulatedLine, RendersChangesAsFullSequencesDo) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = line_scene();
  scene.sensor.full_well_e = scene.sensor.read_noise_e = 0.0;
  SceneSettings whole = scene;
  whole.render.method = RenderSettings::Method::kIntegrated;
  const ImageF changes = SimulatedLine(store, scene).part(2).aspect;
  const ImageF frames = SimulatedLine(store, whole).part(2).aspect;
  ASSERT_EQ(changes.size(), frames.size());
  // Tiles near a defect are intersected ray by ray, those of the flawless part by their nodes.
  constexpr float kBetweenNodes = 1e-3F;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_NEAR(changes.values()[i], frames.values()[i], kBetweenNodes) << i;
  }
}

TEST(SimulatedLine, MasksWhatTheSlotMakesUneven) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = line_scene();
  const SimulatedLine whole(store, scene);
  EXPECT_GT(whole.region_share(), 0.99);
  scene.tunnel.slot_mm = 20.0;  // mirrored as a dark band along the strip
  const SimulatedLine slotted(store, scene);
  EXPECT_LT(slotted.region_share(), 0.95);
  EXPECT_GT(slotted.region_share(), 0.3);
}

TEST(SimulatedLine, FindsDeepDentsAndNothingOnFlawlessParts) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SimulatedLine line(store, line_scene());
  const double threshold = line.threshold();
  int found = 0;
  int alarms = 0;
  for (int number = 0; number < 5; ++number) {
    const ScannedPart part = line.part(number);
    const DetectionMatches matches =
        match_detections(line.inspect(part, threshold), part.defects, {});
    found += matches.found();
    alarms += matches.false_alarms();
    alarms += static_cast<int>(line.inspect(line.flawless(number), threshold).size());
  }
  EXPECT_EQ(found, 15);
  EXPECT_LE(alarms, 1);
}

// Another way of making the same defects: a displaced mesh.
TEST(SimulatedLine, ScansPartsWithOtherDefects) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = line_scene();
  const SimulatedLine line(store, scene);
  std::vector<NamedGroup> none;
  const ScannedPart flawless = line.part_with(none, 3);
  EXPECT_TRUE(flawless.defects.empty());
  std::vector<NamedGroup> deeper = scene.defects;
  deeper[0].second.height_mm = 0.008;
  const ScannedPart part = line.part_with(deeper, 3);
  ASSERT_EQ(part.defects.size(), 3U);
  EXPECT_EQ(part.defects[0].outline.centre_mm, line.part(3).defects[0].outline.centre_mm);
  EXPECT_NE(part.aspect, line.part(3).aspect);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspection_line/visibility.h"

#include <cmath>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "metrics/statistics/estimate.h"
#include "studies/evaluation/evaluation.h"
#include "studies/inspection_line/visibility_trials.h"
#include "studies/inspection_line/visibility_windows.h"
#include "tests/studies/inspection_line/visibility_support.h"

namespace glint {
namespace {

using ::testing::Each;
using ::testing::UnorderedElementsAre;

std::vector<std::string> keys_of(const Scores& scores) {
  std::vector<std::string> keys;
  for (const auto& [name, value] : scores) {
    keys.push_back(name);
  }
  return keys;
}

/// Everything that a line can tell.
std::vector<std::string> every_score() {
  std::vector<std::string> names;
  for (const std::string& name : score_names({}, std::vector<std::string>{"dent"})) {
    if (is_of_line(name)) {
      names.push_back(name);
    }
  }
  return names;
}

Scores scores_with(int threads, const SceneSettings& scene, const std::vector<std::string>& names) {
  ThreadPool pool(threads);
  SceneStore store(pool);
  return visibility_scores(store, scene, names);
}

TEST(VisibilityScores, HoldWhatIsAskedForWithItsBounds) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = small_line(0.1, 0.2);
  EXPECT_TRUE(visibility_scores(store, scene, {}).empty());
  const std::vector<std::string> picture = {"homogeneity.h_rms", "homogeneity.h_rms.low"};
  EXPECT_TRUE(visibility_scores(store, scene, picture).empty());
  EXPECT_EQ(store.num_traced(), 0);  // nothing asked, nothing paid
  const std::vector<std::string> share = {"inspection.region_share"};
  EXPECT_THAT(keys_of(visibility_scores(store, scene, share)),
              UnorderedElementsAre("inspection.region_share"));
  const std::vector<std::string> rate = {"inspection.detection_rate.low"};
  EXPECT_THAT(keys_of(visibility_scores(store, scene, rate)),
              UnorderedElementsAre("inspection.detection_rate",
                                   "inspection.detection_rate.high",
                                   "inspection.detection_rate.low"));
}

TEST(VisibilityScores, CountWhatTheLineFinds) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = small_line(0.02, 0.08);
  const SimulatedLine line(store, scene);
  const double threshold = line.threshold();
  std::int64_t found = 0;
  std::int64_t made = 0;
  for (int k = 0; k < scene.inspection.trials.parts; ++k) {
    const ScannedPart part = line.part(k);
    const DetectionMatches matches =
        match_detections(line.inspect(part, threshold), part.defects, scene.inspection.trials);
    found += matches.found();
    made += static_cast<std::int64_t>(part.defects.size());
  }
  ASSERT_GT(found, 0);
  ASSERT_LT(found, made);
  const Estimate expected = wilson(found, made, 0.95);
  const std::vector<std::string> names = {"inspection.detection_rate",
                                          "inspection.dent.detection_rate"};
  const Scores scores = visibility_scores(store, scene, names);
  for (const std::string& name : names) {
    EXPECT_EQ(scores.at(name), expected.value);
    EXPECT_EQ(scores.at(name + ".low"), expected.low);
    EXPECT_EQ(scores.at(name + ".high"), expected.high);
  }
}

// Each figure again from the line's own pictures, blobs and verdicts.
TEST(RunTrials, MeasuresEachDefectOnThePicturesOfItsPart) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = small_line(0.05, 0.3);
  scene.defects[0].second.type = DefectType::kBump;
  const SimulatedLine line(store, scene);
  const LineTrials trials = run_trials(line, {.parts = true, .largest = true}, 3, pool);
  int dark = 0;
  double signature = 0.0;
  for (std::size_t k = 0; k < trials.parts.size(); ++k) {
    const ScannedPart part = line.part(3 + static_cast<std::int64_t>(k));
    const auto blobs = line.inspect(part, trials.threshold);
    const DetectionMatches matches = match_detections(blobs, part.defects, scene.inspection.trials);
    for (std::size_t i = 0; i < part.defects.size(); ++i) {
      const DefectView& view = part.defects[i].view;
      const auto reach = static_cast<float>(scene.inspection.trials.hit_radii);
      float lowest = 0.0F;
      float highest = 0.0F;
      for (int y = 0; y < view.distance.height(); ++y) {
        for (int x = 0; x < view.distance.width(); ++x) {
          const float value = part.response(x + view.left_px, y + view.top_px);
          lowest = view.distance(x, y) <= reach ? std::min(lowest, value) : lowest;
          highest = view.distance(x, y) <= reach ? std::max(highest, value) : highest;
        }
      }
      double area_px = 0.0;
      for (std::size_t b = 0; b < blobs.size(); ++b) {
        area_px += matches.defect_of_blob[b] == static_cast<int>(i) ? blobs[b].area_px : 0;
      }
      const DefectTrial& trial = trials.parts[k].defects[i];
      EXPECT_EQ(trial.is_found, matches.is_found(i));
      EXPECT_EQ(trial.largest, static_cast<double>(std::max(highest, -lowest)));
      EXPECT_NEAR(trial.signature, trial.is_found ? area_px / view.area_px : 0.0, 1e-9);
      dark += -lowest > highest ? 1 : 0;
      signature += trial.signature;
    }
  }
  EXPECT_GT(dark, 0) << "the sign must matter";
  EXPECT_GT(signature, 0.0);
}

TEST(RunTrials, CountsFalseAlarmsOnOtherScansThanThoseOfTheThreshold) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = small_line(0.1, 0.2);
  scene.inspection.false_alarms_per_picture = 4.0;
  const SimulatedLine line(store, scene);
  const LineTrials trials = run_trials(line, {.flawless = true}, 0, pool);
  const auto blobs_from = [&](std::int64_t first) {
    std::int64_t blobs = 0;
    for (std::int64_t n = 0; n < scene.inspection.trials.flawless; ++n) {
      blobs += std::ssize(line.inspect(line.flawless(first + n), trials.threshold));
    }
    return blobs;
  };
  EXPECT_EQ(trials.flawless, scene.inspection.trials.flawless);
  EXPECT_EQ(trials.false_alarms, blobs_from(scene.inspection.trials.flawless));
  EXPECT_NE(trials.false_alarms, blobs_from(0));
}

// A stain is seen or missed, but has no depth.
TEST(RunTrials, LeavesStainsOutOfWhatIsSaidOfDepths) {
  SceneSettings scene = small_line(0.02, 0.15);
  DefectGroup stains = scene.defects[0].second;
  stains.type = DefectType::kStain;
  stains.height_mm = 50.0;
  scene.defects = {{"stain", stains}};
  const std::vector<std::string> names = {
      "inspection.pod_a90_um", "inspection.smallest_height_um", "inspection.smallest_slope_mrad"};
  EXPECT_TRUE(scores_with(2, scene, names).empty());
}

TEST(VisibilityScores, AreTheSameForAnyNumberOfThreads) {
  const SceneSettings scene = small_line(0.02, 0.08);
  const Scores one = scores_with(1, scene, every_score());
  for (const std::string& name : every_score()) {
    EXPECT_TRUE(one.contains(name)) << name;
    const bool is_estimate = interval_of(name) == ScoreInterval::kTrials;
    EXPECT_EQ(one.contains(name + ".low"), is_estimate) << name;
    EXPECT_EQ(one.contains(name + ".high"), is_estimate) << name;
  }
  EXPECT_EQ(scores_with(2, scene, every_score()), one);
  EXPECT_EQ(scores_with(7, scene, every_score()), one);
}

TEST(VisibilityScores, AreTheSameWhenCandidatesShareTheStore) {
  ThreadPool pool(2);
  SceneStore store(pool);
  std::vector<SceneSettings> scenes(4, small_line(0.02, 0.08));
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    scenes[i].tunnel.period_mm = 8.0 + 2.0 * static_cast<double>(i);
  }
  const WantedScores wanted = {
      .trials = {"inspection.detection_rate", "inspection.dprime", "homogeneity.h_rms.low"}};
  std::vector<Scores> scores(scenes.size());
  {
    std::vector<std::jthread> jobs;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      jobs.emplace_back([&, i] { scores[i] = evaluate(store, scenes[i], {}, wanted).scores; });
    }
  }
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    ThreadPool alone(1);
    SceneStore own(alone);
    EXPECT_EQ(evaluate(own, scenes[i], {}, wanted).scores, scores[i]) << i;
  }
}

/// Correlation of two pictures over a region, less what is expected in each.
double correlation(const Mask& region, const ImageF& a, const ImageF& b) {
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region.values()[i] != 0) {
      const auto x = static_cast<double>(a.values()[i]);
      const auto y = static_cast<double>(b.values()[i]);
      ab += x * y;
      aa += x * x;
      bb += y * y;
    }
  }
  return ab / std::sqrt(aa * bb);
}

ImageF less(ImageF image, const ImageF& expected) {
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.values()[i] -= expected.values()[i];
  }
  return image;
}

TEST(CommonRandomNumbers, ShowTwoLightingsTheSameDefectsAndTheSameNoise) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = small_line(0.1, 0.2);
  SceneSettings other_scene = scene;
  other_scene.tunnel.period_mm = 11.0;
  other_scene.tunnel.radius_mm = 170.0;
  const SimulatedLine line(store, scene);
  const SimulatedLine other(store, other_scene);
  for (int k = 0; k < 3; ++k) {
    const ScannedPart a = line.part(k);
    const ScannedPart b = other.part(k);
    ASSERT_EQ(a.defects.size(), b.defects.size());
    for (std::size_t i = 0; i < a.defects.size(); ++i) {
      EXPECT_EQ(a.defects[i].defect.depth_mm, b.defects[i].defect.depth_mm);
      EXPECT_EQ(a.defects[i].outline.centre_mm, b.defects[i].outline.centre_mm);
    }
    EXPECT_NE(a.aspect, b.aspect);
    const ImageF noise = less(line.flawless(k).aspect, line.expected_aspect());
    const ImageF same = less(other.flawless(k).aspect, other.expected_aspect());
    const ImageF next = less(other.flawless(k + 1).aspect, other.expected_aspect());
    EXPECT_GT(correlation(line.region(), noise, same), 0.9);
    EXPECT_LT(std::abs(correlation(line.region(), noise, next)), 0.05);
  }
}

TEST(VisibilityScores, OfOtherPartsAreOthers) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const std::vector<std::string> names = {"inspection.dprime"};
  const SceneSettings scene = small_line(0.05, 0.2);
  EXPECT_NE(visibility_scores(store, scene, names).at("inspection.dprime"),
            visibility_scores(store, scene, names, kFreshParts).at("inspection.dprime"));
}

TEST(VisibilityScores, FallWithTheDefects) {
  const std::vector<std::string> names = {
      "inspection.auc", "inspection.dprime", "inspection.signature", "inspection.detection_rate"};
  const Scores deep = scores_with(2, small_line(0.3, 0.4), names);
  const Scores flat = scores_with(2, small_line(0.0005, 0.001), names);
  EXPECT_EQ(deep.at("inspection.detection_rate"), 1.0);
  EXPECT_GT(deep.at("inspection.auc"), 0.99);
  EXPECT_GT(deep.at("inspection.dprime"), 5.0);
  EXPECT_GT(deep.at("inspection.signature"), 0.2);
  EXPECT_LT(flat.at("inspection.detection_rate"), 0.2);
  EXPECT_NEAR(flat.at("inspection.auc"), 0.5, 0.3);
  EXPECT_LT(flat.at("inspection.dprime"), 3.0);
}

// Twice and half the smallest height: nearly all and nearly none are found.
TEST(VisibilityScores, PartFoundFromMissedAtTheSmallestHeight) {
  const SceneSettings scene = small_line(2.0, 2.0);
  const Scores scores =
      scores_with(2, scene, {"inspection.smallest_height_um", "inspection.smallest_slope_mrad"});
  ASSERT_TRUE(scores.contains("inspection.smallest_height_um"));
  const double smallest_um = scores.at("inspection.smallest_height_um");
  EXPECT_LE(scores.at("inspection.smallest_height_um.low"), smallest_um);
  EXPECT_GE(scores.at("inspection.smallest_height_um.high"), smallest_um);
  const auto rate = [](double height_um) {
    return scores_with(2, small_line(height_um, height_um), {"inspection.detection_rate"})
        .at("inspection.detection_rate");
  };
  EXPECT_GT(rate(2.0 * smallest_um), 0.85);
  EXPECT_LT(rate(0.5 * smallest_um), 0.3);
  // The slope of a Gaussian of height h and sigma s is h / (s sqrt(e)), with s = diameter / 4 from
  // 0.15 to 0.25 mm: per um 4.04 to 2.43 mrad.
  const double slope_per_um = scores.at("inspection.smallest_slope_mrad") / smallest_um;
  EXPECT_GT(slope_per_um, 2.43);
  EXPECT_LT(slope_per_um, 4.04);
}

TEST(VisibilityScores, HaveTheSameSmallestHeightWhateverTheSceneBeginsWith) {
  const std::string name = "inspection.smallest_height_um";
  const double from_shallow = scores_with(2, small_line(0.01, 0.01), {name}).at(name);
  const double from_deep = scores_with(2, small_line(1.0, 1.0), {name}).at(name);
  EXPECT_NEAR(from_shallow, from_deep, 0.05 * from_deep);
}

TEST(VisibilityScores, FindTheSizeThatIsFoundNineTimesOfTen) {
  SceneSettings scene = small_line(0.01, 0.15);
  scene.inspection.trials.parts = 20;
  const Scores scores = scores_with(2, scene, {"inspection.pod_a90_um"});
  const double a90_um = scores.at("inspection.pod_a90_um");
  EXPECT_GT(a90_um, 0.036);  // of which half are found
  EXPECT_LT(a90_um, 0.12);
  EXPECT_LT(scores.at("inspection.pod_a90_um.low"), a90_um);
  EXPECT_GT(scores.at("inspection.pod_a90_um.high"), a90_um);
  const Scores fixed = scores_with(2, small_line(2.0, 2.0), {"inspection.pod_a90_um"});
  EXPECT_FALSE(fixed.contains("inspection.pod_a90_um"));  // sizes do not vary
}

TEST(Evaluate, PutsBoundsAroundScoresOfOnePicture) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = small_line(0.1, 0.2);
  EXPECT_FALSE(evaluate(store, scene).scores.contains("homogeneity.h_rms.low"));
  const WantedScores wanted = {.trials = {"homogeneity.h_rms.low", "defects.min_cnr.high"}};
  const Scores scores = evaluate(store, scene, {}, wanted).scores;
  EXPECT_LT(scores.at("homogeneity.h_rms.low"), scores.at("homogeneity.h_rms.high"));
  EXPECT_NEAR(scores.at("homogeneity.h_rms.low"), scores.at("homogeneity.h_rms"), 0.01);
  // The mean of 8 CNRs and Student's 2.365 s / sqrt(8) about it, by hand.
  std::vector<double> values;
  for (int k = 0; k < scene.inspection.trials.noise_seeds; ++k) {
    SceneSettings other = scene;
    other.sensor.seed += k;
    values.push_back(evaluate(store, other).scores.at("defects.min_cnr"));
  }
  double mean = 0.0;
  double squares = 0.0;
  for (const double value : values) {
    mean += value / 8.0;
  }
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  const double half = 2.364624 * std::sqrt(squares / 7.0 / 8.0);
  EXPECT_NEAR(scores.at("defects.min_cnr.low"), mean - half, 1e-5 * mean);
  EXPECT_NEAR(scores.at("defects.min_cnr.high"), mean + half, 1e-5 * mean);
}

TEST(WantedBy, AsksForTrialsWhereAScoreNeedsThem) {
  const Goal goal = {.objective = {.name = "inspection.detection_rate"},
                     .constraints = {{.name = "homogeneity.h_rms", .min = 0.9},
                                     {.name = "defects.min_cnr.low", .min = 3.0}}};
  const WantedScores wanted = wanted_by(goal);
  EXPECT_THAT(wanted.trials,
              UnorderedElementsAre("inspection.detection_rate", "defects.min_cnr.low"));
  EXPECT_TRUE(wanted.defects);
  EXPECT_FALSE(wanted.fringes);
  EXPECT_TRUE(wanted.of_one_scan().trials.empty());
}

TEST(WindowAt, AveragesBlocksAndTakesOutsideForZero) {
  ImageF image(20, 20);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      image(x, y) = static_cast<float>(x + 100 * y);
    }
  }
  const std::vector<double> fine = window_at(image, 10, 10, {.step_px = 1});
  ASSERT_EQ(fine.size(), 49);
  EXPECT_EQ(fine[24], 1010.0);            // the middle
  EXPECT_EQ(fine[0], 7.0 + 100.0 * 7.0);  // three to the left and up
  const std::vector<double> coarse = window_at(image, 10, 10, {.step_px = 2});
  EXPECT_EQ(coarse[24], 9.5 + 100.0 * 9.5);  // pixels 9 and 10 of rows 9 and 10
  EXPECT_EQ(window_at(image, 0, 0, {.step_px = 1})[0], 0.0);
}

// sigma 0.02, a spot of amplitude 0.03 over 3 x 3 samples: d' = 0.03 sqrt(9) / 0.02 = 4.5.
TEST(SquaredDprimes, AreThoseOfASpotInWhiteNoise) {
  ThreadPool pool(2);
  Rng rng(3, Stream::kTest, 0);
  const auto noise = [&] {
    std::vector<double> window(49);
    for (double& value : window) {
      value = 0.02 * rng.normal();
    }
    return window;
  };
  std::vector<std::vector<double>> background;
  for (int k = 0; k < 196; ++k) {
    background.push_back(noise());
  }
  std::vector<DefectWindow> spots;
  std::vector<DefectWindow> nothing;
  for (int k = 0; k < 200; ++k) {
    spots.push_back({.with = noise(), .without = noise(), .mean = std::vector<double>(49, 0.0)});
    nothing.push_back(spots.back());
    for (int y = 2; y < 5; ++y) {
      for (int x = 2; x < 5; ++x) {
        spots.back().with[static_cast<std::size_t>(7 * y + x)] += 0.03;
      }
    }
  }
  const auto mean_of_squares = [&](const std::vector<DefectWindow>& windows) {
    double sum = 0.0;
    for (const double squared : squared_dprimes(windows, background, pool)) {
      sum += squared / static_cast<double>(windows.size());
    }
    return sum;
  };
  EXPECT_NEAR(mean_of_squares(spots), 4.5 * 4.5, 2.5);
  EXPECT_NEAR(mean_of_squares(nothing), 0.0, 2.5);
}

TEST(BackgroundWindows, AreTakenFromTheRegionAlone) {
  const std::vector<ImageF> flawless(3, ImageF(100, 50, 1.0F));
  Mask region(100, 50);
  EXPECT_TRUE(background_windows(flawless, region, {}).empty());
  for (int y = 10; y < 40; ++y) {
    for (int x = 60; x < 90; ++x) {
      region(x, y) = 1;
    }
  }
  std::vector<ImageF> marked = flawless;
  for (ImageF& image : marked) {
    for (int y = 0; y < 50; ++y) {
      for (int x = 0; x < 60; ++x) {
        image(x, y) = 7.0F;
      }
    }
  }
  const auto windows = background_windows(marked, region, {});
  EXPECT_EQ(windows.size(), 196);
  for (const std::vector<double>& window : windows) {
    EXPECT_THAT(window, Each(1.0));
  }
}

}  // namespace
}  // namespace glint

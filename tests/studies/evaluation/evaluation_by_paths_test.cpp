// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation/evaluation.h"

#include <cmath>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "studies/definition/scene_viewpoints.h"
#include "tests/studies/imaging/path_support.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

Scores path_scores(const SceneSettings& scene, const WantedScores& wanted = {}, int threads = 2) {
  ThreadPool pool(threads);
  SceneStore store(pool);
  return evaluate(store, scene, {}, wanted).scores;
}

std::string path_scores_error(const SceneSettings& scene, const WantedScores& wanted = {}) {
  try {
    path_scores(scene, wanted);
    return "";
  } catch (const ConfigError& error) {
    return error.what();
  }
}

TEST(EvaluateByPaths, ScoresOneFrameUnderAreaLights) {
  ThreadPool pool(2);
  SceneStore store(pool);
  int frames = 0;
  const Evaluation evaluation =
      evaluate(store, path_scene(), [&](int, const ImageF&) { ++frames; }, {.family = true});
  EXPECT_EQ(frames, 1);
  const Scores& scores = evaluation.scores;
  EXPECT_GT(scores.at("homogeneity.mean"), 0.0);
  EXPECT_GT(scores.at("defects.dent_1.change"), 0.0);
  EXPECT_EQ(scores.at("defects.made"), 1.0);
  EXPECT_TRUE(scores.contains("homogeneity.residual.error"));
  for (const char* name : {"view.slot_margin_mm",
                           "view.hidden_share",
                           "rays.blocked_share",
                           "fringe.period_px",
                           "homogeneity.ripple",
                           "defects.made.error"}) {
    EXPECT_FALSE(scores.contains(name)) << name;
  }
  for (const auto& [name, value] : scores) {
    EXPECT_TRUE(std::isfinite(value)) << name;
    EXPECT_TRUE(explain_score(name).has_value()) << name;
  }
  EXPECT_TRUE(evaluation.traced->flawless_corners.empty());
}

TEST(EvaluateByPaths, OnlyWhatIsWantedIsDone) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const Scores scores =
      evaluate(store, path_scene(), {}, {.fringes = false, .defects = false, .slot = false}).scores;
  EXPECT_EQ(store.num_rendered(), 1);  // no flawless windows
  EXPECT_FALSE(scores.contains("defects.dent_1.cnr"));
  EXPECT_TRUE(scores.contains("homogeneity.h_rms.error"));
  const Scores quiet =
      evaluate(store,
               path_scene(),
               {},
               {.fringes = false, .defects = false, .slot = false, .errors = false})
          .scores;
  EXPECT_FALSE(quiet.contains("homogeneity.h_rms.error"));
  SceneSettings whole = path_scene();
  whole.paths.batches = 1;
  EXPECT_FALSE(path_scores(whole).contains("homogeneity.h_rms.error"));
}

// Red light alone drives the red channel to full scale; the mean of the channels stays at a third.
TEST(EvaluateByPaths, AColourSensorClipsChannelByChannel) {
  SceneSettings scene = path_scene();
  scene.sensor.wavelengths_nm = {630.0, 532.0, 465.0};
  for (NamedLight& light : scene.lights) {
    std::visit(
        [](auto& settings) {
          if constexpr (requires { settings.emission; }) {
            settings.emission.radiance = {1000.0, 0.0, 0.0};
          }
        },
        light.settings);
  }
  const Scores scores = path_scores(scene);
  EXPECT_GT(scores.at("homogeneity.clipped_share"), 0.9);
  EXPECT_NEAR(scores.at("homogeneity.mean"), 1.0 / 3.0, 0.01);
}

TEST(EvaluateByPaths, ScoresTheFirstViewpointOfASet) {
  SceneSettings scene = path_scene();
  scene.defects.clear();
  scene.viewpoint_set = {.source = ViewpointSource::kSphere, .count = 3, .polar_max_rad = 0.5};
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings listed = scene;
  listed.viewpoints = {viewpoints_of(scene, store.build(scene)->part).front()};
  listed.viewpoint_set = {};
  EXPECT_EQ(evaluate(store, scene).scores, evaluate(store, listed).scores);
  scene.viewpoint_set = {};
  EXPECT_NE(evaluate(store, scene).scores, evaluate(store, listed).scores);
}

TEST(EvaluateByPaths, DesignsThatDifferInPowersRenderOnceInAnyOrder) {
  const auto scene_with_powers = [](double ring, double left) {
    SceneSettings scene = path_scene();
    std::get<RingSettings>(scene.lights[0].settings).emission.radiance = {ring};
    std::get<BarSettings>(scene.lights[1].settings).emission.power_w = {left};
    return scene;
  };
  ThreadPool pool(2);
  SceneStore store(pool);
  const WantedScores wanted = {.family = true};
  const Scores first = evaluate(store, scene_with_powers(0.2, 1.0), {}, wanted).scores;
  for (int i = 0; i < 5; ++i) {
    evaluate(store, scene_with_powers(0.1 * i, 0.5), {}, wanted);
  }
  EXPECT_EQ(store.num_rendered(), 2);  // with the defect, and its window without
  const Scores last = evaluate(store, scene_with_powers(0.7, 0.01), {}, wanted).scores;
  EXPECT_NE(first.at("homogeneity.h_rms"), last.at("homogeneity.h_rms"));
  // As when it is the first and only one: a resumed search finds the same.
  EXPECT_EQ(last, path_scores(scene_with_powers(0.7, 0.01), wanted));
}

TEST(EvaluateByPaths, IsTheSameForAnyNumberOfThreads) {
  SceneSettings scene = path_scene();
  scene.paths.relative_error = 0.05;
  scene.paths.samples = 64;
  const Scores one = path_scores(scene, {.family = true}, 1);
  EXPECT_EQ(one, path_scores(scene, {.family = true}, 2));
  EXPECT_EQ(one, path_scores(scene, {.family = true}, 7));
}

TEST(EvaluateByPaths, SeveralThreadsShareOnePicture) {
  ThreadPool pool(2);
  SceneStore store(pool);
  std::vector<Scores> scores(4);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < scores.size(); ++i) {
      threads.emplace_back([&, i] { scores[i] = evaluate(store, path_scene()).scores; });
    }
  }
  EXPECT_EQ(store.num_rendered(), 2);
  for (const Scores& one : scores) {
    EXPECT_EQ(one, scores.front());
  }
  EXPECT_GT(store.kept_bytes(), 48U * 32U * 60U);
}

TEST(EvaluateByPaths, TasksOfThePoolMayAskForPicturesToo) {
  ThreadPool pool(3);
  SceneStore store(pool);
  const auto scores = pool.map<Scores>(12, [&](std::int64_t i) {
    SceneSettings scene = path_scene();
    scene.paths.seed = static_cast<int>(i % 3);
    return evaluate(store, scene).scores;
  });
  for (std::size_t i = 3; i < scores.size(); ++i) {
    EXPECT_EQ(scores[i], scores[i % 3]);
  }
}

TEST(EvaluateByPaths, ADentWithoutHeightChangesNothing) {
  SceneSettings scene = path_scene();
  scene.defects[0].second.height_mm = 1e-9;
  const Scores scores = path_scores(scene);
  EXPECT_LT(scores.at("defects.dent_1.change"), 1e-5);
  EXPECT_EQ(scores.at("defects.dent_1.union"), 0.0);
}

TEST(EvaluateByPaths, NoiseOfPathsIsNoChange) {
  // The same dent, found whole with many samples, is not more than whole with few.
  SceneSettings scene = path_scene();
  scene.paths.samples = 4;
  scene.paths.batches = 4;
  EXPECT_LE(path_scores(scene).at("defects.dent_1.union"), 1.2);
}

TEST(EvaluateByPaths, ATunnelBringsItsFramesAndScores) {
  SceneSettings scene =
      path_scene("[lighting.tunnel]\nradius_mm = 60\nslot_mm = 16\nperiod_mm = 8\n");
  scene.scan.positions = 4;
  scene.material.roughness = 0.05;
  ThreadPool pool(2);
  SceneStore store(pool);
  int frames = 0;
  const Scores scores = evaluate(store, scene, [&](int, const ImageF&) { ++frames; }).scores;
  EXPECT_EQ(frames, 4);
  EXPECT_TRUE(scores.contains("view.slot_margin_mm"));
  EXPECT_EQ(scores.at("view.hidden_share"), 0.0);
  EXPECT_GT(scores.at("homogeneity.mean.error"), 0.0);
  scene.tunnel.radius_mm = 2.0;
  EXPECT_THAT(path_scores_error(scene), HasSubstr("the tunnel is smaller than the part"));
}

TEST(EvaluateByPaths, AMirrorUnderATunnelScoresAsWithoutPaths) {
  SceneSettings scene = path_scene("[lighting.tunnel]\nradius_mm = 60\nslot_mm = 4\n");
  scene.material = {};
  scene.scan.positions = 4;
  scene.defects[0].second.height_mm = 0.01;
  scene.paths.samples = 256;
  const WantedScores wanted = {.family = true};
  ASSERT_FALSE(needs_paths(scene));
  const Scores exact = path_scores(scene, wanted);
  scene.render.method = RenderSettings::Method::kPaths;
  const Scores traced = path_scores(scene, wanted);
  for (const char* name : {"homogeneity.mean",
                           "homogeneity.h_rms",
                           "homogeneity.h_abs",
                           "homogeneity.residual",
                           "defects.dent_1.change"}) {
    EXPECT_NEAR(traced.at(name), exact.at(name), 0.02) << name;
    EXPECT_NEAR(traced.at(name), exact.at(name), 5.0 * traced.at(error_name(name)) + 0.005) << name;
  }
  EXPECT_NEAR(traced.at("view.slot_margin_mm"), exact.at("view.slot_margin_mm"), 0.01);
}

// The wall is 60 mm above the plate, the camera 100 mm: through half a slot of 0.75 mm it sees
// 0.75 * 100 / 40 = 1.9 mm of the 3.2 mm on either side.
TEST(EvaluateByPaths, TheWallHidesAsMuchOfThePartAsWithoutPaths) {
  SceneSettings scene = path_scene("[lighting.tunnel]\nradius_mm = 60\nslot_mm = 1.5\n");
  scene.material = {};
  scene.scan.positions = 4;
  scene.paths.samples = 16;
  ASSERT_FALSE(needs_paths(scene));
  const double exact = path_scores(scene).at("view.hidden_share");
  scene.render.method = RenderSettings::Method::kPaths;
  EXPECT_GT(exact, 0.05);
  EXPECT_NEAR(path_scores(scene).at("view.hidden_share"), exact, 1e-3);
}

TEST(EvaluateByPaths, RefusesWhatHasNoMeaning) {
  EXPECT_THAT(path_scores_error(path_scene(), {.gradients = {.scores = {"homogeneity.h_rms"}}}),
              HasSubstr("search.algorithm: needs derivatives"));
  SceneSettings dark = path_scene();
  dark.paths.has_light = false;
  EXPECT_THAT(path_scores_error(dark), HasSubstr("render.paths.light: is false"));
  SceneSettings unlit = path_scene();
  unlit.lights.clear();
  unlit.has_tunnel = false;
  EXPECT_THAT(path_scores_error(unlit), HasSubstr("lighting: holds no light"));
}

/// Means over seeds of contrasts that noise still lowers by a quarter.
Scores mean_contrasts(SceneSettings scene, bool is_debiased) {
  scene.paths.samples = 64;
  scene.paths.has_bias_taken_off = is_debiased;
  ThreadPool pool(2);
  SceneStore store(pool);
  constexpr int kSeeds = 40;
  Scores mean;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    scene.paths.seed = seed;
    const Scores scores = evaluate(store, scene, {}, {.fringes = false}).scores;
    for (const char* name : {"defects.dent_1.cnr", "defects.min_cnr", "defects.dent_1.union"}) {
      mean[name] += scores.at(name) / kSeeds;
    }
  }
  return mean;
}

TEST(EvaluateByPaths, TheBiasOfNoiseIsTakenOffContrastsWhereTheSceneSaysSo) {
  const SceneSettings scene = path_scene();
  SceneSettings fine = scene;
  fine.paths.samples = 2048;
  const double truth = path_scores(fine).at("defects.dent_1.cnr");
  const Scores plain = mean_contrasts(scene, false);
  const Scores debiased = mean_contrasts(scene, true);
  const double bias = plain.at("defects.dent_1.cnr") - truth;
  EXPECT_GT(std::abs(bias), 0.05 * truth) << "there is a bias to take off";
  EXPECT_LT(std::abs(debiased.at("defects.dent_1.cnr") - truth), 0.5 * std::abs(bias));
  EXPECT_EQ(debiased.at("defects.min_cnr"), debiased.at("defects.dent_1.cnr"));
  EXPECT_EQ(debiased.at("defects.dent_1.union"), plain.at("defects.dent_1.union"));
}

TEST(EvaluateByPaths, ABiasIsTakenOffWhetherErrorsAreWantedOrNot) {
  SceneSettings scene = path_scene();
  const double plain = path_scores(scene).at("defects.dent_1.weber");
  scene.paths.has_bias_taken_off = true;
  const double debiased = path_scores(scene).at("defects.dent_1.weber");
  EXPECT_NE(debiased, plain);
  EXPECT_EQ(path_scores(scene, {.errors = false}).at("defects.dent_1.weber"), debiased);
}

TEST(EvaluateByPaths, StandardErrorsAgreeWithTheScatterOverSeeds) {
  SceneSettings scene = path_scene();
  scene.paths.samples = 32;
  scene.paths.batches = 8;
  ThreadPool pool(2);
  SceneStore store(pool);
  constexpr int kSeeds = 30;
  const std::vector<std::string> names = {
      "homogeneity.mean", "homogeneity.h_rms", "defects.dent_1.weber", "defects.dent_1.change"};
  std::map<std::string, std::vector<double>> values;
  std::map<std::string, double> squared_errors;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    scene.paths.seed = seed;
    const Scores scores = evaluate(store, scene).scores;
    for (const std::string& name : names) {
      values[name].push_back(scores.at(name));
      squared_errors[name] += std::pow(scores.at(error_name(name)), 2) / kSeeds;
    }
  }
  for (const std::string& name : names) {
    double mean = 0.0;
    double squares = 0.0;
    for (const double value : values[name]) {
      mean += value / kSeeds;
    }
    for (const double value : values[name]) {
      squares += (value - mean) * (value - mean) / (kSeeds - 1);
    }
    const double ratio = std::sqrt(squared_errors[name] / squares);
    EXPECT_GT(ratio, 1.0 / 1.5) << name;
    EXPECT_LT(ratio, 1.5) << name;
  }
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The same search twice, with the same seed and budget: designs rendered by the study's own
// samples, and by sums of direct light. Both winners are scored again in the same way, by several
// times the samples with other random numbers. Counted work and CPU time are of the searches alone;
// times are printed, not asserted.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/cpu_clock.h"
#include "core/error.h"
#include "core/file.h"
#include "optimizer/storage/storage.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/searched/searched_scene.h"
#include "studies/run/study_search.h"
#include "tests/studies/gallery/gallery_support.h"
#include "tests/support/temporary_folder.h"

namespace glint::direct_search_test {
namespace {

constexpr int kTopSamples = 512;
constexpr int kTopBatches = 8;
constexpr int kOtherSeed = 5000011;
constexpr int kMinEvaluations = 30;

/// What one of the two searches came to.
struct Found {
  int evaluations = 0;
  double work = 0.0;   ///< counted, of the search
  double cpu_s = 0.0;  ///< the same
  double top = 0.0;    ///< the winner's objective by paths of many samples
  double error = 0.0;  ///< its standard error
};

RenderRung rung_with(const Study& study, const std::string& name) {
  const std::vector<RenderRung> ladder = render_ladder(study.scene, {});
  const auto found = std::ranges::find(ladder, name, &RenderRung::name);
  if (found == ladder.end()) {
    throw ConfigError("the study's ladder has no rung \"" + name + "\"");
  }
  return *found;
}

/// @param score  the objective
void score_again(const Study& study, const std::string& score, const Point& winner, Found& found) {
  SceneSettings scene = scene_with(study, overrides_of(study, winner));
  scene.paths.samples = kTopSamples;
  scene.paths.batches = kTopBatches;
  scene.paths.seed += kOtherSeed;
  ThreadPool pool(2);
  SceneStore store(pool);
  store.leave_out_unseen_defects();
  const Scores scores = evaluate(store, scene).scores;
  found.top = scores.at(score);
  found.error = scores.at(score + ".error");
}

/// @param rung  nullptr: the study's own samples
Found searched(const Study& study, const std::string& score, const RenderRung* rung) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "study.sqlite",
                                  {.config_hash = "a", .config_text = "", .code_version = "t"});
  ThreadPool pool(1);
  SceneStore store(pool);
  store.leave_out_unseen_defects();
  Found found;
  const auto evaluate_point = [&](const Point& point, int /*trial*/) {
    SceneSettings scene = scene_with(study, overrides_of(study, point));
    scene = rung != nullptr ? searched_scene(store, scene, *rung, {}) : scene;
    found.work += counted_work(scene);
    return Outcome{.scores = evaluate(store, scene, {}, wanted_in_search(study)).scores};
  };
  const double start = process_cpu_s();
  const SearchResult result = run_search(search_task(study, 1), storage, evaluate_point);
  found.cpu_s = process_cpu_s() - start;
  found.evaluations = result.evaluations;
  EXPECT_EQ(result.failed, 0);
  EXPECT_TRUE(result.best.has_value());
  if (result.best) {
    score_again(study, score, result.best->point, found);
  }
  return found;
}

void tell(const std::string& how, const Found& found) {
  fmt::print("{}: {} evaluations, counted work {:.2f}, {:.1f} s of CPU; winner {:.4g} +- {:.2g}\n",
             how,
             found.evaluations,
             found.work,
             found.cpu_s,
             found.top,
             found.error);
}

void compare(const Study& study,
             const std::string& score,
             const std::string& name = "direct sum, 4 rays a pixel") {
  const RenderRung rung = rung_with(study, name);
  const Found paths = searched(study, score, nullptr);
  tell(fmt::format("{} samples", study.scene.paths.samples), paths);
  const Found sums = searched(study, score, &rung);
  tell(name, sums);
  const double behind = paths.top - sums.top;
  const double noise = std::hypot(paths.error, sums.error);
  fmt::print(
      "sums: {:.2f} of the counted work, {:.2f} of the CPU time; winner behind by {:.4g} +- "
      "{:.2g}\n",
      sums.work / paths.work,
      sums.cpu_s / paths.cpu_s,
      behind,
      noise);
  EXPECT_GE(sums.evaluations, kMinEvaluations);
  EXPECT_LT(sums.work, paths.work);
  EXPECT_LT(behind, 2.0 * noise) << "the winner is no worse";
}

Study gallery_study(const std::string& name, int larger_pixels) {
  std::vector<KeyValue> sets = {{"budget.evaluations", std::to_string(kMinEvaluations)}};
  const Study whole = load_study(gallery::folder_of(name) / "study.toml", {});
  const CameraSettings& camera = whole.scene.camera;
  sets.push_back({"camera.width_px", std::to_string(camera.width_px / larger_pixels)});
  sets.push_back({"camera.height_px", std::to_string(camera.height_px / larger_pixels)});
  sets.push_back(
      {"camera.object_pixel_mm", fmt::format("{}", camera.object_pixel_mm * larger_pixels)});
  return load_study(gallery::folder_of(name) / "study.toml", sets);
}

TEST(DirectSearch, OfRingGeometryFindsNoWorseARing) {
  compare(gallery_study("ring_geometry", 2), "defects.min_dprime");
}

// Ring and dome together are not summed but followed by paths.
TEST(DirectSearch, OfWhichLightFindsNoWorseALight) {
  compare(gallery_study("which_light", 1), "defects.min_dprime");
}

// Teeth shade each other, so that each place on the lamp is asked for: sums of one ray a pixel.
TEST(DirectSearch, OfAGearFindsNoWorseARing) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             fmt::format("schema = 1\ninclude = [\"{}\"]\n"
                         "[material]\ntype = \"conductor\"\nalpha = [0.2]\n"
                         "[camera]\nwidth_px = 153\nheight_px = 128\npixel_um = 55.2\n"
                         "focal_mm = 12\nworking_distance_mm = 146\n"
                         "[[viewpoint]]\nposition_mm = [129, -17.7, -66.0]\n"
                         "direction = [-129, 17.7, 66.0]\nup = [0, 0, 1]\n"
                         "[lighting.ring]\nmount = \"camera\"\nheight_mm = 20\nradiance = [20]\n"
                         "[render.paths]\nsamples = 64\nmax_reflections = 1\nbatches = 4\n"
                         "[variables]\n"
                         "\"lighting.ring.inner_radius_mm\" = {{ min = 15, max = 45 }}\n"
                         "\"lighting.ring.outer_radius_mm\" = {{ min = 50, max = 100 }}\n"
                         "\"lighting.ring.height_mm\" = {{ min = 0, max = 60 }}\n"
                         "[objective]\nmaximise = \"homogeneity.h_rms\"\n"
                         "[search]\nalgorithm = \"cobyla\"\nbatch = 2\n"
                         "[budget]\nevaluations = {}\n",
                         (gallery::folder_of("gear_defects") / "scene.toml").string(),
                         kMinEvaluations));
  compare(load_study(folder / "study.toml", {}), "homogeneity.h_rms", "direct sum, 1 ray a pixel");
}

}  // namespace
}  // namespace glint::direct_search_test

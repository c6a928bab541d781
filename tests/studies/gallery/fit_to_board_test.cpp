// SPDX-License-Identifier: GPL-3.0-or-later
//
// studies/gallery/fit_to_board against the photographs that it is fitted to, and others. They lie
// beside the sources and not in every checkout. Slow.
#include <cstdio>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "studies/evaluation/evaluation.h"
#include "studies/run/run.h"
#include "tests/studies/gallery/gallery_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Json = nlohmann::ordered_json;

constexpr const char* kGallery = "fit_to_board";
constexpr const char* kRms = "appearance.rms";
constexpr const char* kEdges = "overlap.edge_distance_px";

const fs::path kPhotographs = fs::path(GLINT_SHARED_DIR) / "data/calibration/board_on_robot";

Study read(const std::string& file, const std::vector<KeyValue>& sets = {}) {
  return load_study(gallery::folder_of(kGallery) / file, sets);
}

Scores scores_of(const Study& study, const SceneSettings& scene) {
  ThreadPool pool(2);
  SceneStore store(pool);
  return evaluate(store, scene, {}, wanted_by(study.goal)).scores;
}

/// The variables of a result, for another study of the same scene.
std::vector<KeyValue> sets_of(const Json& variables) {
  std::vector<KeyValue> sets;
  for (const auto& [name, value] : variables.items()) {
    sets.push_back({name, shortest(value.get<double>())});
  }
  return sets;
}

TEST(GalleryFitToBoard, SaysWhichPhotographIsMissing) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "1/2/3");
  fs::copy(gallery::folder_of(kGallery), folder / "1/2/3/fit_to_board");
  EXPECT_THAT([&] { load_study(folder / "1/2/3/fit_to_board/fit.toml", {}); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("fit.toml:"),
                                               HasSubstr("reference.pictures"),
                                               HasSubstr("img00.png"),
                                               HasSubstr("does not exist"))));
}

TEST(GalleryFitToBoard, SceneNeedsNoPhotographs) {
  EXPECT_FALSE(read("scene.toml").scene.reference.has_value());
}

// 1920 pixels found the focal length to be 2747.5 with a variance of 14.683: a quarter and a 16th.
TEST(GalleryFitToBoard, CalibrationIsThatOfTheLargerPixels) {
  const std::string text = read_file(gallery::folder_of(kGallery) / "calibration.toml");
  EXPECT_THAT(text, HasSubstr("width_px = 480\n"));
  EXPECT_THAT(text, HasSubstr("focal_x_px = 686.878"));
  EXPECT_THAT(text, HasSubstr("\nintrinsics = [0.917695"));
  EXPECT_THAT(text, HasSubstr("1.079594219500692e-7]\nhand_eye"));
  EXPECT_EQ(read("scene.toml").scene.camera.width_px, 480);
}

TEST(GalleryFitToBoard, ReadmePrintsTheExpectedNumbers) {
  gallery::expect_printed_numbers(kGallery, 20);
}

/// What expected.json has of a design.
void expect_row(const std::string& design, const Scores& scores) {
  std::printf("%s: rms %.5f, edges %.4f px\n", design.c_str(), scores.at(kRms), scores.at(kEdges));
  int compared = 0;
  for (const auto& [key, row] : gallery::read_expected(kGallery)) {
    if (key.starts_with(design + ".") && scores.contains(key.substr(design.size() + 1))) {
      EXPECT_NEAR(scores.at(key.substr(design.size() + 1)), row.value, row.tolerance) << key;
      ++compared;
    }
  }
  EXPECT_GE(compared, 2) << design;
}

TEST(GalleryFitToBoard, ScoresAreThePromisedOnes) {
  if (!fs::exists(kPhotographs)) {
    GTEST_SKIP() << kPhotographs << " is not there";
  }
  const Study fit = read("fit.toml");
  const Study other = read("held_out.toml");
  expect_row("baseline", scores_of(fit, fit.scene));
  expect_row("held_out_baseline", scores_of(other, other.scene));
  const Prototype& found = other.prototypes.at(0);
  expect_row("winner", scores_of(fit, scene_with(fit, found.overrides)));
  expect_row("held_out_winner", scores_of(other, scene_with(other, found.overrides)));
}

// One key of what was found is changed, all others stay: how much worse the pictures become tells
// how well the photographs determine it.
TEST(GalleryFitToBoard, SlicesTellWhatPhotographsDetermine) {
  if (!fs::exists(kPhotographs)) {
    GTEST_SKIP() << kPhotographs << " is not there";
  }
  const Study fit = read("fit.toml");
  const std::vector<std::tuple<std::string, std::string, double>> slices = {
      {"brighter", "sensor.exposure", 0.904},
      {"matt", "material.coat.roughness", 1.0},
      {"glossy", "material.coat.roughness", 0.4},
      {"left", "lighting.lamp.position_mm.0", -56.0},
      {"narrow", "lighting.lamp.half_angle_deg", 36.0},
      {"straight", "lighting.lamp.direction.1", 0.0},
      {"moved", "cell.flange_from_part.translation_mm.0", 18.42}};
  for (const auto& [name, key, value] : slices) {
    Overrides changed = read("held_out.toml").prototypes.at(0).overrides;
    std::erase_if(changed, [&key = key](const auto& one) { return one.first == key; });
    changed.emplace_back(key, ConfigNode::from_number(value));
    expect_row(name, scores_of(fit, scene_with(fit, changed)));
  }
}

// The first 65 of the 100 evaluations that the README tells: the best of them is better on
// photographs that the search has not seen, too.
TEST(GalleryFitToBoard, FirstEvaluationsHalveTheDifferenceAndLessenItOnOtherPhotographs) {
  if (!fs::exists(kPhotographs)) {
    GTEST_SKIP() << kPhotographs << " is not there";
  }
  const TemporaryFolder out;
  const Study fit = read("fit.toml", {{"budget.evaluations", "65"}});
  const Json result = run_study(
      fit, {.out = out / "run", .threads = 2, .jobs = 2, .progress = Progress::Style::kNone});
  const Scores start = scores_of(fit, fit.scene);
  const Json& found = result.at("best").at("scores");
  std::printf("fitted: rms %.4f to %.4f\n", start.at(kRms), found.at(kRms).get<double>());
  EXPECT_LT(found.at(kRms).get<double>(), 0.5 * start.at(kRms));
  EXPECT_LE(found.at(kEdges).get<double>(), 0.5);

  const Study other = read("held_out.toml");
  const Study others = read("held_out.toml", sets_of(result.at("best").at("variables")));
  const Scores before = scores_of(other, other.scene);
  const Scores after = scores_of(others, others.scene);
  std::printf("held out: rms %.4f to %.4f\n", before.at(kRms), after.at(kRms));
  EXPECT_LT(after.at(kRms), 0.85 * before.at(kRms));
  EXPECT_LE(after.at(kEdges), 0.5);
}

}  // namespace
}  // namespace glint

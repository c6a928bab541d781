// SPDX-License-Identifier: GPL-3.0-or-later
//
// A search that is checked in random pixels, with pictures and evaluations that are made up: at the
// cheap rung all designs have a mean of 0.5 and pixels of 0.4 and 0.6.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/accuracy/accuracy_check.h"
#include "studies/accuracy/search_review.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/support/temporary_folder.h"

namespace glint::sampled_review_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kRms = "homogeneity.h_rms";
constexpr double kBound = 0.01;
constexpr std::size_t kMadePixels = 4;  ///< of each made square

/// 32 squares with their surroundings are 0.08 of 320 x 320 pixels; at rungs of work 1 and 2 they
/// take 0.24.
constexpr double kSampleWork = 0.24;

const std::string kStudy = R"(schema = 1
[part]
shape = "plate"
length_mm = 40
width_mm = 40
thickness_mm = 1
[material]
type = "conductor"
roughness = 0.5
[camera]
width_px = 320
height_px = 320
object_pixel_mm = 0.1
working_distance_mm = 100
[sensor]
bits = 0
)" + kPathRing + R"(
[render]
method = "paths"
[render.paths]
samples = 16
max_reflections = 1
[variables]
"lighting.ring.height_mm" = { min = 1, max = 60 }
[objective]
maximise = "homogeneity.h_rms"
[search]
algorithm = "random"
[budget]
evaluations = 90
[accuracy]
keep = ["render.method"]
tolerance = { "homogeneity.h_rms" = 0.01 }
)";

RenderRung path_rung(const std::string& name, int samples, double work, bool is_for_search) {
  RenderRung rung = {.name = name, .level = "direct light", .render = {}, .paths = {}};
  rung.paths.samples = samples;
  rung.paths.max_reflections = 1;
  rung.work = work;
  rung.is_for_search = is_for_search;
  rung.is_noisy = true;
  return rung;
}

/// Of two rungs the cheaper one, by whose bound h is within kBound; the dearer one is only compared
/// with, so that no check begins an epoch.
ChosenAccuracy coarse_choice() {
  ChosenAccuracy chosen;
  chosen.ladder = {path_rung("8 samples", 8, 1.0, true), path_rung("16 samples", 16, 2.0, false)};
  chosen.choice.step = 0;
  chosen.choice.second = 1;
  chosen.choice.steps.resize(2);
  chosen.choice.steps[0].bounds = {{.score = kRms, .factor = 3.0, .bound = kBound}};
  return chosen;
}

/// Trial n: the later, the better by 1e-6, at a height of n mm.
std::vector<Trial> made_trials(int count) {
  std::vector<Trial> trials;
  for (int n = 1; n <= count; ++n) {
    Trial& trial = trials.emplace_back();
    trial.number = n;
    trial.point = {static_cast<double>(n)};
    trial.outcome = Outcome{.scores = {{kRms, 0.8 + 1e-6 * n},
                                       {"homogeneity.mean", 0.5},
                                       {"homogeneity.clipped_share", 0.0}}};
  }
  return trials;
}

int number_of(const Overrides& overrides) {
  return static_cast<int>(std::lround(overrides.at(0).second.number));
}

/// All pixels twice as far from their mean at the dearer rung: h is 0.6 there.
/// @param stretch  2; 1: they are the same
std::vector<SampledSquare> made_squares(double stretch) {
  SampledSquare square;
  for (std::size_t i = 0; i < kMadePixels; ++i) {
    const double cheap = i % 2 == 0 ? 0.4 : 0.6;
    square.push_back({.cheap = cheap, .dearer = 0.5 + stretch * (cheap - 0.5)});
  }
  return std::vector<SampledSquare>(kSampledSquares, square);
}

/// A review of made trials, and what it asked for.
struct MadeReview {
  explicit MadeReview(Storage* storage = nullptr)
      : study(loaded()), store(pool), record(storage), chosen(coarse_choice()) {
    task.record = storage;
    task.evaluate = [this](const Overrides& overrides, const RenderRung& rung) {
      EXPECT_EQ(rung.name, "16 samples");
      evaluated.push_back(number_of(overrides));
      return Outcome{.scores = {{kRms, 0.8 + dearer_is_off}}};
    };
    task.sample = [this](const Overrides& overrides,
                         const RenderRung& cheap,
                         const RenderRung& dearer,
                         const Rng& rng) -> std::optional<std::vector<SampledSquare>> {
      EXPECT_EQ(cheap.name, "8 samples");
      EXPECT_EQ(dearer.name, "16 samples");
      const int number = number_of(overrides);
      sampled.push_back(number);
      draws.insert(Rng(rng).next_u32());
      return has_squares ? std::optional(made_squares(number == doubtful ? 2.0 : 1.0))
                         : std::nullopt;
    };
  }

  static Study loaded() {
    const TemporaryFolder folder;
    write_file(folder / "study.toml", kStudy);
    return load_study(folder / "study.toml", {});
  }

  /// Once, or as a search goes on: after each trial from the 20th. @return the checks at the end
  std::vector<CheckedDesign> review(int count, bool is_step_by_step = false) {
    SearchReview search_review(task, record, chosen);
    const std::vector<Trial> trials = made_trials(count);
    for (int told = is_step_by_step ? 20 : count; told <= count; ++told) {
      EXPECT_FALSE(search_review.review(std::span(trials).first(static_cast<std::size_t>(told))));
    }
    work = search_review.work();
    undecided = search_review.undecided();
    return search_review.checked();
  }

  Study study;
  ThreadPool pool{1};
  SceneStore store;
  AccuracyTask task = {.study = study, .store = store};
  AccuracyRecord record;
  ChosenAccuracy chosen;
  int doubtful = 0;            ///< the trial of which random pixels differ
  bool has_squares = true;     ///< false: no picture can be rendered in parts
  double dearer_is_off = 0.0;  ///< of whole pictures
  std::vector<int> evaluated;  ///< as whole pictures
  std::vector<int> sampled;
  std::set<std::uint32_t> draws;
  std::vector<int> undecided;
  double work = 0.0;
};

std::vector<int> numbers_of(const std::vector<CheckedDesign>& designs) {
  std::vector<int> numbers;
  for (const CheckedDesign& design : designs) {
    numbers.push_back(design.trial);
  }
  return numbers;
}

// A tenth of 20 evaluations pays for one whole picture, or for eight checks in random pixels.
TEST(SampledReview, ChecksManyDesignsForTheWorkOfOne) {
  MadeReview made;
  const std::vector<CheckedDesign> checked = made.review(20);
  ASSERT_THAT(checked, SizeIs(8));
  EXPECT_EQ(checked[0].trial, 20) << "the best first";
  EXPECT_TRUE(checked[0].is_finalist);
  for (const CheckedDesign& design : checked) {
    EXPECT_THAT(design.beyond, IsEmpty());
    ASSERT_TRUE(design.sampled);
    EXPECT_EQ(design.sampled->pixels, static_cast<int>(kSampledSquares * kMadePixels));
    EXPECT_NEAR(design.sampled->errors.at(kRms).difference, 0.0, 1e-4);
  }
  EXPECT_NEAR(made.work, 8.0 * kSampleWork, 1e-12);
  EXPECT_THAT(made.evaluated, IsEmpty());
  EXPECT_EQ(made.sampled, numbers_of(checked));
  EXPECT_EQ(made.draws.size(), 8U) << "each design has squares of its own";
  EXPECT_THAT(made.review(19), IsEmpty());
}

// 0.24 + 2 is within a tenth of 23 evaluations, not of 22; until then nothing else is checked.
TEST(SampledReview, EvaluatesTheWholePictureOfWhatIsInDoubt) {
  MadeReview made;
  made.doubtful = 20;
  EXPECT_THAT(made.review(22, true), IsEmpty());
  EXPECT_THAT(made.undecided, ElementsAre(20));
  EXPECT_NEAR(made.work, kSampleWork, 1e-12);
  EXPECT_THAT(made.evaluated, IsEmpty());
  std::vector<CheckedDesign> checked = made.review(23, true);
  ASSERT_THAT(checked, SizeIs(1));
  EXPECT_EQ(checked[0].trial, 20);
  EXPECT_FALSE(checked[0].sampled);
  EXPECT_THAT(checked[0].beyond, IsEmpty()) << "the whole picture has the last word";
  EXPECT_THAT(made.undecided, IsEmpty());
  EXPECT_NEAR(made.work, kSampleWork + 2.0, 1e-12);
  EXPECT_THAT(made.evaluated, ElementsAre(20));
  EXPECT_THAT(made.sampled, ElementsAre(20)) << "once";
}

TEST(SampledReview, FindsADesignBeyondItsBoundByTheWholePicture) {
  MadeReview made;
  made.doubtful = 20;
  made.dearer_is_off = -2.0 * kBound;
  const std::vector<CheckedDesign> checked = made.review(23);
  ASSERT_THAT(checked, SizeIs(1));
  EXPECT_THAT(checked[0].beyond, ElementsAre(kRms));
}

TEST(SampledReview, EvaluatesWhatCannotBeRenderedInPartsAsAWhole) {
  MadeReview made;
  made.has_squares = false;
  const std::vector<CheckedDesign> checked = made.review(22, true);
  ASSERT_THAT(checked, SizeIs(1));
  EXPECT_FALSE(checked[0].sampled);
  EXPECT_NEAR(made.work, 2.0, 1e-12) << "nothing was rendered for the squares";
  EXPECT_THAT(made.evaluated, ElementsAre(20));
  EXPECT_THAT(made.sampled, ElementsAre(20)) << "asked once";
}

// All pixels are the same at both rungs, but the whole picture is less even than they tell.
TEST(SampledReview, SquaresThatMissAHighlightConfirmNothing) {
  const ChosenAccuracy chosen = coarse_choice();
  const std::vector<SampledSquare> squares = made_squares(1.0);
  const auto is_confirmed_at = [&](double h_rms) {
    const Scores whole = {{kRms, h_rms}, {"homogeneity.mean", 0.5}};
    const SampledError found = sampled_error(kRms, whole, squares).value();
    EXPECT_NEAR(found.difference, 0.0, 1e-12);
    EXPECT_NEAR(found.off, 0.8 - h_rms, 1e-12);
    return is_confirmed(
        chosen, whole, {.pixels = 128, .squares = 32, .errors = {{kRms, found}}}, 0.99);
  };
  EXPECT_TRUE(is_confirmed_at(0.8));
  EXPECT_TRUE(is_confirmed_at(0.795)) << "within the bound";
  EXPECT_FALSE(is_confirmed_at(0.78));
}

// Student's quantile of 31 degrees of freedom at 99 % is 2.744.
TEST(SampledReview, ABoundIsConfirmedWithTheErrorOfTheSample) {
  const ChosenAccuracy chosen = coarse_choice();
  const auto is_within = [&](double difference, double error, const Scores& scores = {}) {
    const SampledCheck check = {
        .pixels = 100, .squares = 32, .errors = {{kRms, {difference, error}}}};
    return is_confirmed(chosen, scores, check, 0.99);
  };
  EXPECT_TRUE(is_within(0.009, 0.0003));
  EXPECT_TRUE(is_within(-0.009, 0.0003));
  EXPECT_FALSE(is_within(0.009, 0.0004));
  EXPECT_FALSE(is_within(-0.009, 0.0004));
  EXPECT_FALSE(is_within(0.011, 0.0));
  // A design that is noisier than those of the trial has a bound of its own: 3 x 0.005.
  EXPECT_TRUE(is_within(0.011, 0.0, {{"homogeneity.h_rms.error", 0.005}}));
  EXPECT_FALSE(is_confirmed(chosen, {}, {.pixels = 100, .squares = 32, .errors = {}}, 0.99))
      << "nothing was sampled";
}

TEST(SampledReview, IsOfScoresThatFollowFromPixelsAndOfLargePictures) {
  MadeReview made;
  const RenderRung& dearer = made.chosen.ladder[1];
  EXPECT_NEAR(sampled_work(made.task, made.chosen, dearer).value(), kSampleWork, 1e-12);
  for (const char* other : {"defects.min_cnr", "homogeneity.clipped_share"}) {
    ChosenAccuracy with_other = coarse_choice();
    with_other.choice.steps[0].bounds.push_back({.score = other, .bound = 0.1});
    EXPECT_FALSE(may_be_sampled(made.task, with_other)) << other;
  }
  ChosenAccuracy half = coarse_choice();
  half.ladder[0].pixel_factor = 2;
  EXPECT_FALSE(sampled_work(made.task, half, dearer));
  ChosenAccuracy summed = coarse_choice();
  summed.ladder[0].is_noisy = false;
  EXPECT_FALSE(sampled_work(made.task, summed, dearer));
  made.study.scene.camera.width_px = 64;  // 0.4 of the picture
  EXPECT_FALSE(sampled_work(made.task, made.chosen, dearer));
}

StudyIdentity made_identity() {
  return {.config_hash = "abc", .config_text = "", .code_version = "test"};
}

TEST(SampledReview, ASearchThatBeganWithWholePicturesGoesOnWithThem) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "accuracy.sqlite", made_identity());
  MadeReview made(&storage);
  made.record.begin_search("8 samples");
  EXPECT_EQ(made.record.begun_with_sampled_checks(), false);
  const std::vector<CheckedDesign> checked = made.review(20);
  ASSERT_THAT(checked, SizeIs(1));
  EXPECT_FALSE(checked[0].sampled);
  EXPECT_THAT(made.sampled, IsEmpty());
}

TEST(SampledReview, GoesOnFromTheRecordWithoutRendering) {
  const TemporaryFolder folder;
  std::vector<CheckedDesign> expected;
  double work = 0.0;
  {
    Storage storage = Storage::open(folder / "accuracy.sqlite", made_identity());
    MadeReview made(&storage);
    made.record.begin_search("8 samples", kBranchRules, true);
    made.doubtful = 20;
    expected = made.review(40);
    work = made.work;
    EXPECT_GT(expected.size(), 4U);
    EXPECT_THAT(made.evaluated, ElementsAre(20));
  }
  Storage storage = Storage::open(folder / "accuracy.sqlite", made_identity());
  EXPECT_EQ(storage.events().at(0).value, kPixelRules);
  MadeReview made(&storage);
  EXPECT_NO_THROW(made.record.check_rules(true));
  EXPECT_EQ(made.record.begun_rules(), kBranchRules) << "of its rung";
  EXPECT_EQ(made.record.begun_with_sampled_checks(), true);
  const std::vector<CheckedDesign> checked = made.review(40, true);
  EXPECT_EQ(numbers_of(checked), numbers_of(expected));
  for (std::size_t i = 0; i < checked.size(); ++i) {
    ASSERT_EQ(checked[i].sampled.has_value(), expected[i].sampled.has_value());
    if (checked[i].sampled) {
      EXPECT_EQ(checked[i].sampled->errors.at(kRms).difference,
                expected[i].sampled->errors.at(kRms).difference);
    }
  }
  EXPECT_EQ(made.work, work);
  EXPECT_THAT(made.evaluated, IsEmpty());
  EXPECT_THAT(made.sampled, IsEmpty());
}

/// The same study with a picture of 96 x 72 pixels.
Study small_study(const TemporaryFolder& folder) {
  std::string text = kStudy;
  for (const char* side : {"96", "72"}) {
    text.replace(text.find("320"), 3, side);
  }
  write_file(folder / "study.toml", text);
  return load_study(folder / "study.toml", {});
}

// Rendered: what 32 squares of a plate tell is what both whole pictures do.
TEST(SampledReview, TellsOfARenderedDesignWhatItsWholePicturesDo) {
  const TemporaryFolder folder;
  const Study study = small_study(folder);
  ThreadPool pool(2);
  SceneStore store(pool);
  const AccuracyTask task = {.study = study, .store = store};
  AccuracyRecord record(nullptr);
  const ChosenAccuracy chosen = coarse_choice();
  const RenderRung& dearer = chosen.ladder[1];
  Trial trial = made_trials(30).back();
  const Overrides overrides = overrides_of(study, trial.point);
  trial.outcome = evaluate_at(store, study, overrides, chosen.ladder[0]);
  ASSERT_FALSE(trial.outcome->is_failed) << trial.outcome->message;
  const Outcome whole = evaluate_at(store, study, overrides, dearer);
  const double difference = whole.scores.at(kRms) - trial.outcome->scores.at(kRms);
  EXPECT_GT(difference, 0.0) << "noise makes a picture less even";
  const auto check = recorded_sample(task, record, chosen, trial, dearer);
  ASSERT_TRUE(check);
  EXPECT_EQ(check->squares, kSampledSquares);
  const SampledError found = check->errors.at(kRms);
  EXPECT_NEAR(found.difference, difference, 5.0 * found.error);
  EXPECT_NEAR(found.off, 0.0, 5.0 * found.off_error);
  const auto again = recorded_sample(task, record, chosen, trial, dearer);
  EXPECT_EQ(again.value().errors.at(kRms).difference, found.difference);
  EXPECT_EQ(store.num_rendered(), 2) << "no whole picture but those of this test";
}

TEST(SampledReview, IsTold) {
  MadeReview made;
  made.doubtful = 20;
  AccuracyCheck check = {.during = made.review(40), .during_work = made.work};
  check.undecided = {39};
  const nlohmann::ordered_json told = check_json(made.chosen, check, 40);
  EXPECT_EQ(told["during"]["undecided"][0], 39);
  const auto& designs = told["during"]["designs"];
  EXPECT_FALSE(designs[0].contains("pixels")) << "of the one in doubt all pixels were compared";
  EXPECT_EQ(designs[1]["pixels"], kSampledSquares * kMadePixels);
  EXPECT_TRUE(designs[1]["differences"][kRms].contains("error"));
  const auto sentence = told["sentence"].get<std::string>();
  EXPECT_THAT(sentence, HasSubstr("of them in random pixels alone, none beyond the bounds"));
  EXPECT_THAT(sentence, HasSubstr("Random pixels left evaluation 39 in doubt"));
}

}  // namespace
}  // namespace glint::sampled_review_test

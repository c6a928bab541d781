// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scores of a picture that is none of the program's: evaluate() asks nothing but its interface.
#include "studies/evaluation/evaluation.h"

#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace glint {
namespace {

using ::testing::ElementsAre;

/// A row of six pixels on the part.
ImageF row_of(const std::array<float, 6>& values) {
  ImageF row(6, 1);
  for (int x = 0; x < 6; ++x) {
    row(x, 0) = values.at(static_cast<std::size_t>(x));
  }
  return row;
}

/// @param is_limited  a pixel is left bent at four cells: larger numbers were not allowed
std::shared_ptr<const TracedScene> six_pixels(bool is_limited = false) {
  TracedScene traced;
  if (is_limited) {
    traced.corners.refined.push_back({.cells_per_axis = 4, .is_smooth = {1, 1, 0, 1}});
  }
  traced.part = std::make_shared<const BuiltDefects>();
  Mask all(6, 1);
  for (int x = 0; x < 6; ++x) {
    all(x, 0) = 1;
  }
  traced.part_mask = all;
  traced.region = Region(all);
  return std::make_shared<const TracedScene>(std::move(traced));
}

class FakePicture : public ScenePicture {
 public:
  explicit FakePicture(const std::array<float, 6>& values, bool is_limited = false)
      : ScenePicture({}, six_pixels(is_limited)), whole_(row_of(values)) {}

  bool has_whole_frames(bool is_consumed, bool wants_fringes) const override {
    asked_.emplace_back(is_consumed, wants_fringes);
    return is_consumed;
  }

  MeanImage mean(const MeanRequest& request) const override {
    if (request.watch) {
      request.watch(0, whole_);
    }
    MeanImage mean = {.aspect = request.without ? without.at(*request.without) : whole_,
                      .frames = 1};
    mean.hidden_share = hidden_share;
    mean.form.frame_pixels = 6;
    return mean;
  }

  DefectValues flawless(int /*frame*/, std::optional<std::size_t> /*without*/) const override {
    return {};
  }

  std::size_t batches() const override { return without.size(); }

  const RayCounts* ray_counts() const override { return counts ? &*counts : nullptr; }

  std::vector<ImageF> without;  ///< means of all samples but one batch each
  std::optional<double> hidden_share;
  std::optional<RayCounts> counts;
  mutable std::vector<std::pair<bool, bool>> asked_;

 private:
  ImageF whole_;
};

constexpr std::array<float, 6> kUneven = {0.4F, 0.6F, 0.4F, 0.6F, 0.4F, 0.6F};

// Mean 0.5 and standard deviation 0.1: h is 1 - 0.1 / 0.5.
TEST(Evaluate, ScoresWhateverPictureItIsGiven) {
  ThreadPool pool(1);
  const FakePicture picture(kUneven);
  const Evaluation result = evaluate(picture, pool);
  EXPECT_NEAR(result.scores.at("homogeneity.mean"), 0.5, 1e-6);
  EXPECT_NEAR(result.scores.at("homogeneity.h_rms"), 0.8, 1e-6);
  EXPECT_NEAR(result.scores.at("homogeneity.h_abs"), 0.8, 1e-6);
  EXPECT_EQ(result.aspect, row_of(kUneven));
  EXPECT_EQ(result.form.frame_pixels, 6);
  EXPECT_EQ(result.traced, picture.traced());
  EXPECT_TRUE(result.gradients.by_score.empty());
}

TEST(Evaluate, ScoresNoMoreThanIsWanted) {
  ThreadPool pool(1);
  const FakePicture picture(kUneven);
  const WantedScores minimum = {
      .fringes = false, .defects = false, .robust = false, .slot = false, .errors = false};
  const Scores few = evaluate(picture, pool, {}, minimum).scores;
  EXPECT_FALSE(few.contains("homogeneity.robust"));
  EXPECT_FALSE(few.contains("homogeneity.residual"));
  EXPECT_TRUE(evaluate(picture, pool).scores.contains("homogeneity.robust"));
  EXPECT_TRUE(
      evaluate(picture, pool, {}, {.family = true}).scores.contains("homogeneity.residual"));
}

TEST(Evaluate, ShowsFramesToWhoAsksForThem) {
  ThreadPool pool(1);
  const FakePicture picture(kUneven);
  std::vector<int> frames;
  evaluate(picture, pool, [&](int index, const ImageF& grey) {
    frames.push_back(index);
    EXPECT_EQ(grey, row_of(kUneven));
  });
  EXPECT_THAT(frames, ElementsAre(0));
  EXPECT_EQ(picture.asked_.front(), std::make_pair(true, true));
}

// Without one batch each h is 0.7 and 0.9: sqrt(1/2 (0.1^2 + 0.1^2)) = 0.1.
TEST(Evaluate, HasStandardErrorsWhereAPictureHasBatches) {
  ThreadPool pool(2);
  FakePicture picture(kUneven);
  EXPECT_FALSE(evaluate(picture, pool).scores.contains("homogeneity.h_rms.error"));
  picture.without = {row_of({0.35F, 0.65F, 0.35F, 0.65F, 0.35F, 0.65F}),
                     row_of({0.45F, 0.55F, 0.45F, 0.55F, 0.45F, 0.55F})};
  const Scores scores = evaluate(picture, pool).scores;
  EXPECT_NEAR(scores.at("homogeneity.h_rms.error"), 0.1, 1e-6);
  EXPECT_NEAR(scores.at("homogeneity.mean.error"), 0.0, 1e-6);
  EXPECT_FALSE(
      evaluate(picture, pool, {}, {.errors = false}).scores.contains("homogeneity.h_rms.error"));
}

TEST(Evaluate, TellsOfTheViewWhatThePictureKnows) {
  ThreadPool pool(1);
  FakePicture picture(kUneven);
  EXPECT_FALSE(evaluate(picture, pool).scores.contains("view.hidden_share"));
  EXPECT_FALSE(evaluate(picture, pool).scores.contains("rays.followed_share"));
  picture.hidden_share = 0.25;
  picture.counts = RayCounts{.camera = 100, .part = 80, .followed = 20, .blocked = 4};
  const Scores scores = evaluate(picture, pool).scores;
  EXPECT_EQ(scores.at("view.hidden_share"), 0.25);
  EXPECT_EQ(scores.at("rays.followed_share"), 0.25);
  EXPECT_EQ(scores.at("rays.blocked_share"), 0.05);
}

TEST(Evaluate, TellsWhereTooManyRaysWereSaved) {
  ThreadPool pool(1);
  FakePicture picture(kUneven);
  picture.counts = RayCounts{.camera = 100, .part = 80};
  EXPECT_FALSE(evaluate(picture, pool).scores.contains("rays.max_cells"));
  FakePicture limited(kUneven, true);
  limited.counts = picture.counts;
  EXPECT_EQ(evaluate(limited, pool).scores.at("rays.max_cells"), 4.0);
}

}  // namespace
}  // namespace glint

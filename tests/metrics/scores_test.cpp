// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/scores.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "metrics/lighting_scores.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

TEST(Scores, CarryExactlyTheNamesThatAreListed) {
  Scores scores = {// what the rays of a scene tell, filled in by whoever traces them
                   {"view.hidden_share", 0.0},
                   {"view.slot_margin_mm", 0.0},
                   {"rays.followed_share", 0.0},
                   {"rays.blocked_share", 0.0},
                   {"rays.max_cells", 0.0},
                   // and what an inspection line finds out, filled in where it is asked for
                   {"inspection.false_alarms", 0.0},
                   {"inspection.threshold", 0.0},
                   {"inspection.region_share", 0.0},
                   {"inspection.rendering_share", 0.0},
                   // what all views together inspect, and how real pictures compare
                   {"coverage.c1", 0.0},
                   {"coverage.c2", 0.0},
                   {"coverage.redundancy", 0.0},
                   {"coverage.largest_gap_mm2", 0.0},
                   {"reach.share", 0.0},
                   {"reach.margin_mm", 0.0},
                   {"overlap.iou", 0.0},
                   {"overlap.mean_distance_px", 0.0},
                   {"overlap.edge_distance_px", 0.0},
                   {"appearance.ssim", 0.0},
                   {"appearance.rms", 0.0},
                   {"appearance.histogram_distance", 0.0}};
  add_scores(scores, LightingTotals{.size = LightingTotals::Size{}, .scan_s = 0.0, .cost = 0.0});
  add_scores(scores, Homogeneity{.robust = 0.0});
  add_scores(scores, HomogeneityFamily{.ripple = 0.0});
  add_scores(scores, FringeScores{});
  const std::vector<DefectScores> defects = {{.label = "dent"}, {.label = "group.scratch_2"}};
  add_scores(scores, defects);
  add_scores(scores, DefectTotals{.made = 2});
  std::vector<std::string> listed =
      score_names(std::vector<std::string>{"dent", "group.scratch_2"});
  std::sort(listed.begin(), listed.end());
  std::vector<std::string> carried;
  for (const auto& [name, value] : scores) {
    carried.push_back(name);
  }
  EXPECT_EQ(carried, listed);
  for (const std::string& name : listed) {
    EXPECT_TRUE(explain_score(name).has_value()) << name;
  }
}

TEST(Scores, PutValuesUnderTheirNames) {
  Scores scores;
  add_scores(scores, Homogeneity{.h_rms = 0.9, .h_abs = 0.92, .clipped_share = 0.1});
  const std::vector<DefectScores> defects = {{.label = "dent", .weber = -0.2, .cnr = 4.0}};
  add_scores(scores, defects);
  add_scores(scores, {.made = 2, .mean_depth_um = 3.5, .removed_volume_mm3 = 0.25});
  EXPECT_EQ(scores.at("defects.made"), 2.0);
  EXPECT_EQ(scores.at("defects.mean_depth_um"), 3.5);
  EXPECT_EQ(scores.at("defects.removed_volume_mm3"), 0.25);
  EXPECT_EQ(scores.at("homogeneity.h_rms"), 0.9);
  EXPECT_EQ(scores.at("homogeneity.h_abs"), 0.92);
  EXPECT_EQ(scores.at("homogeneity.clipped_share"), 0.1);
  EXPECT_EQ(scores.at("defects.dent.cnr"), 4.0);
  EXPECT_EQ(scores.at("defects.min_weber"), 0.2);
}

TEST(Scores, OfNoDefectsAreAbsent) {
  Scores scores;
  add_scores(scores, std::span<const DefectScores>{});
  add_scores(scores, DefectTotals{});
  EXPECT_TRUE(scores.empty());
  for (const std::string& name : score_names({})) {
    EXPECT_FALSE(name.starts_with("defects.")) << name;
  }
}

TEST(UnknownScore, NamesTheNearestOne) {
  const std::vector<std::string> labels = {"dent"};
  EXPECT_THAT(unknown_score("homogeneity.hrms", labels), HasSubstr("\"homogeneity.h_rms\""));
  EXPECT_THAT(unknown_score("defects.dent.cnrs", labels), HasSubstr("\"defects.dent.cnr\""));
  EXPECT_EQ(unknown_score("defects.dent.cnr", labels), "");
  EXPECT_THAT(unknown_score("defects.min_cnr", {}), HasSubstr("without defects"));
}

TEST(ExplainScore, KnowsEveryLabelAndNoInvention) {
  EXPECT_THAT(std::string(explain_score("defects.any_name.weber").value()),
              HasSubstr("background"));
  EXPECT_FALSE(explain_score("defects..weber").has_value());
  EXPECT_FALSE(explain_score("homogeneity.h_max").has_value());
}

TEST(ScoreNames, HaveInspectionScoresOfEachGroup) {
  const std::vector<std::string> groups = {"dent", "scratches"};
  const std::vector<std::string> names = score_names({}, groups);
  EXPECT_THAT(names, ::testing::Contains("inspection.detection_rate"));
  EXPECT_THAT(names, ::testing::Contains("inspection.scratches.auc"));
  for (const std::string& name : names) {
    EXPECT_TRUE(explain_score(name).has_value()) << name;
    EXPECT_EQ(unknown_score(name, {}, groups), "");
  }
}

TEST(WithoutBound, TakesOneBoundOff) {
  EXPECT_EQ(without_bound("homogeneity.h_rms.low"), "homogeneity.h_rms");
  EXPECT_EQ(without_bound("homogeneity.h_rms.high"), "homogeneity.h_rms");
  EXPECT_EQ(without_bound("homogeneity.h_rms"), "homogeneity.h_rms");
  EXPECT_TRUE(is_bound("inspection.auc.low"));
  EXPECT_FALSE(is_bound("inspection.auc"));
}

TEST(ErrorName, IsExplainedForScoresOfPicturesAndRefusedAsAnAim) {
  EXPECT_EQ(error_name("homogeneity.h_rms"), "homogeneity.h_rms.error");
  EXPECT_EQ(without_error("homogeneity.h_rms.error"), "homogeneity.h_rms");
  EXPECT_EQ(without_error("homogeneity.h_rms"), "homogeneity.h_rms");
  EXPECT_TRUE(is_error("defects.dent_1.cnr.error"));
  EXPECT_FALSE(is_error("defects.dent_1.cnr"));
  EXPECT_FALSE(is_bound("homogeneity.h_rms.error"));
  EXPECT_THAT(explain_score("homogeneity.h_rms.error").value(),
              ::testing::StartsWith("standard error of homogeneity.h_rms"));
  EXPECT_TRUE(explain_score("defects.dent_1.cnr.error").has_value());
  EXPECT_FALSE(explain_score("view.hidden_share.error").has_value());
  EXPECT_FALSE(explain_score("defects.made.error").has_value());
  EXPECT_FALSE(explain_score("no.error").has_value());
  EXPECT_FALSE(explain_score("homogeneity.h_rms.low.error").has_value());
  EXPECT_THAT(unknown_score("homogeneity.h_rms.error", {}),
              ::testing::HasSubstr("comes with homogeneity.h_rms"));
}

TEST(IntervalOf, IsThereForEstimatesAlone) {
  EXPECT_EQ(interval_of("homogeneity.h_rms"), ScoreInterval::kScans);
  EXPECT_EQ(interval_of("defects.dent_1.cnr.high"), ScoreInterval::kScans);
  EXPECT_EQ(interval_of("inspection.detection_rate.low"), ScoreInterval::kTrials);
  EXPECT_EQ(interval_of("inspection.dent.auc"), ScoreInterval::kTrials);
  for (const char* name : {"defects.made", "view.hidden_share", "inspection.region_share", "no"}) {
    EXPECT_EQ(interval_of(name), ScoreInterval::kNone) << name;
  }
}

TEST(UnknownScore, KnowsBoundsAndRefusesThemWhereThereIsNoInterval) {
  const std::vector<std::string> labels = {"dent_1"};
  const std::vector<std::string> groups = {"dent"};
  EXPECT_EQ(unknown_score("inspection.detection_rate.low", labels, groups), "");
  EXPECT_EQ(unknown_score("defects.dent_1.cnr.low", labels, groups), "");
  EXPECT_THAT(unknown_score("view.hidden_share.low", labels, groups), HasSubstr("has no interval"));
  EXPECT_THAT(unknown_score("homogeneity.hrms.low", labels, groups),
              HasSubstr("\"homogeneity.h_rms.low\""));
  EXPECT_THAT(unknown_score("inspection.detection_rates", labels, groups),
              HasSubstr("\"inspection.detection_rate\""));
  EXPECT_THAT(unknown_score("inspection.detection_rate", {}, {}), HasSubstr("without defects"));
  EXPECT_EQ(unknown_score("inspection.false_alarms", {}, {}), "");
}

TEST(ExplainScore, TellsWhereABoundComesFrom) {
  EXPECT_THAT(explain_score("inspection.detection_rate.low").value(),
              HasSubstr("lower bound of the interval of inspection.detection_rate"));
  EXPECT_THAT(explain_score("homogeneity.h_rms.high").value(), HasSubstr("noise_seeds"));
  EXPECT_FALSE(explain_score("view.hidden_share.low").has_value());
  EXPECT_FALSE(explain_score("inspection.detection.low").has_value());
}

TEST(Scores, LeaveARippleOutThatWasNotMeasured) {
  Scores scores;
  add_scores(scores, HomogeneityFamily{.u0 = 0.5});
  EXPECT_EQ(scores.at("homogeneity.u0"), 0.5);
  EXPECT_FALSE(scores.contains("homogeneity.ripple"));
}

TEST(IsOfFamily, HoldsForScoresThatTakePassesOfTheirOwn) {
  EXPECT_TRUE(is_of_family("homogeneity.ripple"));
  EXPECT_TRUE(is_of_family("homogeneity.low_share"));
  EXPECT_TRUE(is_of_family("homogeneity.residual.low"));
  EXPECT_FALSE(is_of_family("homogeneity.h_rms"));
  EXPECT_FALSE(is_of_family("homogeneity.lit_share"));
}

}  // namespace
}  // namespace glint

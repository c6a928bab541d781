// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/inspector_frontier.h"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "studies/inspection_line/visibility.h"
#include "tests/studies/inspection_line/visibility_support.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

SceneSettings dented_strip() {
  SceneSettings scene = small_line(20.0, 60.0);
  scene.inspection.false_alarms_per_picture = 0.5;
  scene.inspection.trials.parts = 4;
  scene.inspection.trials.flawless = 4;
  return scene;
}

TEST(ComparedInspectors, BeginWithTheScenesOwnAndHaveNoTwins) {
  InspectionSettings own;
  own.kernel_px = 31;
  const auto points = compared_inspectors(own);
  EXPECT_TRUE(points.front().is_current);
  EXPECT_EQ(points.front().label, "gaussian 31 px");
  std::set<std::string> labels;
  for (const InspectorPoint& point : points) {
    EXPECT_TRUE(labels.insert(point.label).second) << point.label;
  }
  for (const char* label : {"gaussian 9 px",
                            "difference of gaussians, scales 1, 2, 4 px",
                            "matched 5 px",
                            "structure 16 px"}) {
    EXPECT_TRUE(labels.contains(label)) << label;
  }
}

InspectorPoint measured(double cpu_s, const std::vector<std::pair<double, double>>& curve) {
  InspectorPoint point{.label = "one", .cpu_s = cpu_s};
  for (const auto& [detected, false_reports] : curve) {
    point.curve.push_back(
        {.detected = {.value = detected}, .false_reports = {.value = false_reports}});
  }
  return point;
}

TEST(MarkInspectors, TakesTheMostThatIsFoundAtTheAllowedRate) {
  std::vector<InspectorPoint> points = {measured(2.0, {{1.0, 9.0}, {0.8, 0.1}, {0.5, 0.0}}),
                                        measured(1.0, {{0.9, 5.0}, {0.6, 0.1}}),
                                        measured(3.0, {{0.7, 0.0}}),
                                        measured(0.5, {{0.9, 1.0}})};
  mark_inspectors(0.1, points);
  EXPECT_DOUBLE_EQ(points[0].best->detected.value, 0.8);
  EXPECT_DOUBLE_EQ(points[1].best->detected.value, 0.6);
  EXPECT_FALSE(points[3].best) << "it never keeps to the rate";
  EXPECT_TRUE(points[0].is_on_front);
  EXPECT_TRUE(points[1].is_on_front);
  EXPECT_FALSE(points[2].is_on_front) << "slower and finds less";
  EXPECT_FALSE(points[3].is_on_front);
}

TEST(MeasureInspectors, OwnThresholdFindsWhatTheScoresOfTheLineTell) {
  const SceneSettings scene = dented_strip();
  const InspectorFrontier frontier = measure_inspectors(scene, {.threads = 2});
  ThreadPool pool(2);
  SceneStore store(pool);
  const std::vector<std::string> names = {
      "inspection.detection_rate", "inspection.false_alarms", "inspection.threshold"};
  const Scores scores = visibility_scores(store, scene, names);
  const InspectorPoint& own = frontier.points.front();
  ASSERT_TRUE(own.own) << own.problem;
  EXPECT_EQ(frontier.parts, 4);
  EXPECT_EQ(own.own->detected.value, scores.at("inspection.detection_rate"));
  EXPECT_EQ(own.own->false_reports.value, scores.at("inspection.false_alarms"));
  EXPECT_EQ(own.own->threshold, scores.at("inspection.threshold"));
}

TEST(MeasureInspectors, HigherThresholdsReportLess) {
  const InspectorFrontier frontier = measure_inspectors(dented_strip(), {.threads = 2});
  for (const InspectorPoint& point : frontier.points) {
    ASSERT_EQ(point.problem, "") << point.label;
    EXPECT_GT(*point.cpu_s, 0.0);
    EXPECT_EQ(point.curve.size(), 12U);
    for (std::size_t k = 1; k < point.curve.size(); ++k) {
      EXPECT_GE(point.curve[k].threshold, point.curve[k - 1].threshold);
    }
    EXPECT_LE(point.curve.back().false_reports.value, point.curve.front().false_reports.value);
  }
  EXPECT_TRUE(std::ranges::any_of(frontier.points, [](const InspectorPoint& point) {
    return point.best && point.best->detected.value == 1.0;
  })) << "the dents are easy to see";
}

TEST(MeasureInspectors, BudgetLeavesOutFiltersButNotTheScenesOwn) {
  const InspectorFrontier frontier = measure_inspectors(dented_strip(), {.budget_s = 1e-6});
  EXPECT_EQ(frontier.parts, 2);
  EXPECT_EQ(frontier.points.front().problem, "");
  EXPECT_THAT(frontier.points.back().problem, HasSubstr("the budget of time was used up"));
}

TEST(MeasureInspectors, RefusesASceneWithoutDefects) {
  SceneSettings scene = dented_strip();
  scene.defects.clear();
  EXPECT_THROW(measure_inspectors(scene, {}), ConfigError);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/plan/plan_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/csv.h"
#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::HasSubstr;

ViewPlan small_plan() {
  ViewPlan plan;
  PlannedView seen = {.name = "view_01", .margin_mm = 7.25, .singularity = 0.08};
  seen.base_from_camera.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  seen.base_from_camera.linear() =
      Eigen::AngleAxisd(0.5, Eigen::Vector3d(0.0, 0.6, 0.8)).toRotationMatrix();
  seen.joints_rad << 0.1, -0.2, 0.3, -0.4, 0.5, -6.2;
  PlannedView refused = {.name = "view_02",
                         .outcome = ViewOutcome::kNoPath,
                         .reason = "no way is free",
                         .nearest_base_from_camera = seen.base_from_camera};
  plan.views = {seen, refused};
  plan.paths = {{.from = "home",
                 .to = "view_01",
                 .joints_rad = {JointVector::Zero(), JointVector::Ones(), seen.joints_rad},
                 .margin_mm = 6.5,
                 .duration_s = 3.25}};
  plan.reach_share = 0.5;
  plan.reach_margin_mm = 6.5;
  return plan;
}

TEST(PlanFile, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  const ViewPlan plan = small_plan();
  write_plan({.plan = plan,
              .scene = "scene.toml",
              .cell = "cell.toml",
              .origin = {.scene = "/out/run/wide/scene.toml", .run = "/out/run"}},
             folder / "plan.json");
  const PlanFile read = read_plan(folder / "");
  EXPECT_EQ(read.scene, folder / "scene.toml");
  EXPECT_EQ(read.cell.filename(), "cell.toml");
  EXPECT_EQ(read.origin.scene, "/out/run/wide/scene.toml");
  EXPECT_EQ(read.origin.run, "/out/run");
  ASSERT_EQ(read.plan.views.size(), 2U);
  ASSERT_EQ(read.plan.paths.size(), 1U);
  const PlannedView& view = read.plan.views[0];
  EXPECT_EQ(view.outcome, ViewOutcome::kPlanned);
  EXPECT_TRUE(view.joints_rad.isApprox(plan.views[0].joints_rad, 1e-12));
  EXPECT_TRUE(view.base_from_camera.isApprox(plan.views[0].base_from_camera, 1e-9));
  EXPECT_EQ(view.margin_mm, 7.25);
  EXPECT_EQ(view.singularity, 0.08);
  EXPECT_FALSE(view.nearest_base_from_camera);
  EXPECT_EQ(read.plan.views[1].outcome, ViewOutcome::kNoPath);
  EXPECT_EQ(read.plan.views[1].reason, "no way is free");
  ASSERT_TRUE(read.plan.views[1].nearest_base_from_camera.has_value());
  ASSERT_EQ(read.plan.paths[0].joints_rad.size(), 3U);
  EXPECT_TRUE(read.plan.paths[0].joints_rad[1].isApprox(JointVector::Ones(), 1e-12));
  EXPECT_EQ(read.plan.paths[0].duration_s, 3.25);
  EXPECT_EQ(read.plan.reach_share, 0.5);
  EXPECT_EQ(read.plan.reach_margin_mm, 6.5);
}

TEST(PlanFile, NamesWhatIsWrongInOne) {
  const TemporaryFolder folder;
  write_plan({.plan = small_plan(), .scene = "s", .cell = "c"}, folder / "plan.json");
  const std::string good = read_file(folder / "plan.json");
  const auto problem = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    write_file(folder / "bad.json", text.replace(at, from.size(), to));
    return text_thrown_by<ConfigError>([&] { read_plan(folder / "bad.json"); });
  };
  EXPECT_THAT(problem("\"schema\": 1", "\"schema\": 9"), HasSubstr("is no plan of schema 1"));
  EXPECT_THAT(problem("\"planned\"", "\"perhaps\""),
              HasSubstr("views[0].outcome: \"perhaps\" is no outcome"));
  EXPECT_THAT(problem("\"reason\"", "\"raisin\""), HasSubstr("views[0].reason: is missing"));
  EXPECT_THAT(problem("7.25", "\"wide\""), HasSubstr("views[0].margin_mm: must be a number"));
  EXPECT_THAT(problem("\"run\": null", "\"run\": 1"), HasSubstr("run: must be a text"));
  EXPECT_THAT(problem("\"duration_s\": 3.25", "\"duration_s\": null"),
              HasSubstr("paths[0].duration_s: must be a number"));
  write_file(folder / "bad.json", "{");
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { read_plan(folder / "bad.json"); }),
              HasSubstr("is no JSON"));
  EXPECT_THROW(read_plan(folder / "none.json"), IoError);
}

TEST(PlanCsv, HasARowForEachView) {
  const std::string text = plan_csv(small_plan());
  EXPECT_EQ(std::ranges::count(text, '\n'), 3);
  EXPECT_THAT(text, HasSubstr("view_01,planned,7.250,0.08000,5.7296,"));
  EXPECT_THAT(text, HasSubstr("view_02,no_path,,,,,,,,,"));
}

TEST(PlanCsv, IsReadBackWhateverAReasonHolds) {
  ViewPlan plan = small_plan();
  plan.views[1].reason = "safe position \"home\": the forearm, touches the table";
  const std::vector<CsvRow> rows = parse_csv(plan_csv(plan), "plan.csv");
  ASSERT_EQ(rows.size(), 3U);
  for (const CsvRow& row : rows) {
    EXPECT_EQ(row.size(), rows[0].size());
  }
  EXPECT_EQ(rows[2].back().text, plan.views[1].reason);
}

}  // namespace
}  // namespace glint

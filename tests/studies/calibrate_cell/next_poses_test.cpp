// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/next_poses.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "hardware/planning/clearance.h"
#include "hardware/planning/plan_check.h"
#include "studies/reach/scene_cell.h"
#include "tests/studies/cell/ur3_cells.h"
#include "tests/support/temporary_folder.h"

namespace glint::calibrate_cell_detail {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

JointVector joints_at(double turn_deg) {
  JointVector joints_rad;
  joints_rad << turn_deg, -95, 95, -85, -90, 0;
  return joints_rad * kRadPerDeg;
}

class NextPoses : public testing::Test {
 protected:
  PlanningCell cell_of(const std::string& text) const {
    write_file(folder_ / "cell.toml", text);
    return planning_cell(read_cell(folder_ / "cell.toml"));
  }

  /// Upright, as high as the tool's tip when it is turned by so much about the base.
  std::string post_at(double turn_deg) const {
    const Eigen::Vector3d at_mm =
        cell_of(test::kUr3Cell).arm.arm.forward(joints_at(turn_deg)).translation();
    return fmt::format(
        "[[obstacle]]\nname = \"post\"\nposition_mm = [{}, {}, 135]\nsize_mm = [20, 20, 270]\n",
        at_mm.x(),
        at_mm.y());
  }

  ReachedPoses reached(const std::string& text, std::size_t most) const {
    const PlanningCell cell = cell_of(text);
    std::vector<WantedPose> wanted;
    for (const double turn_deg : {-40.0, 40.0, 60.0}) {
      wanted.push_back({.name = fmt::format("{:g}", turn_deg),
                        .base_from_flange = cell.arm.arm.forward(joints_at(turn_deg))});
    }
    return reached_poses(cell, wanted, most);
  }

  TemporaryFolder folder_;
};

std::vector<std::string> names_of(const std::vector<PlannedView>& views) {
  std::vector<std::string> names;
  for (const PlannedView& view : views) {
    names.push_back(view.name);
  }
  return names;
}

TEST_F(NextPoses, AreTheBestOnesWhereNothingIsInTheWay) {
  const ReachedPoses poses = reached(test::kUr3Cell, 2);
  EXPECT_THAT(names_of(poses.plan.views), ElementsAre("-40", "40"));
  EXPECT_TRUE(poses.refused.empty());
  EXPECT_EQ(poses.plan.paths.size(), 3U);
}

TEST_F(NextPoses, ThatTouchAPostAreReplacedByOthers) {
  const ReachedPoses poses = reached(test::kUr3Cell + post_at(40.0), 2);
  EXPECT_THAT(names_of(poses.plan.views), ElementsAre("-40", "60"));
  ASSERT_THAT(names_of(poses.refused), ElementsAre("40"));
  EXPECT_EQ(name_of(poses.refused[0].outcome), "collision");
  EXPECT_THAT(poses.refused[0].reason, HasSubstr("post"));
}

TEST_F(NextPoses, AreReachedAroundAPost) {
  const std::string text = test::kUr3Cell + post_at(0.0);
  const PlanningCell cell = cell_of(text);
  const ClearanceCheck clearance(cell);
  ASSERT_FALSE(clearance.along(joints_at(-40.0), joints_at(40.0)).is_free());
  const ReachedPoses poses = reached(text, 2);
  EXPECT_THAT(names_of(poses.plan.views), ElementsAre("-40", "40"));
  for (const PlannedPath& path : poses.plan.paths) {
    for (std::size_t i = 1; i < path.joints_rad.size(); ++i) {
      EXPECT_TRUE(clearance.along(path.joints_rad[i - 1], path.joints_rad[i]).is_free());
    }
  }
}

// Pictures of a round that was interrupted are told by the joints that they were taken at.
TEST_F(NextPoses, AreTheSameWhenTheyAreReadAgain) {
  const ReachedPoses poses = reached(test::kUr3Cell + post_at(40.0), 2);
  keep_poses(poses, folder_ / "cell.toml", folder_ / "tour.json");
  const ReachedPoses kept = kept_poses(folder_ / "tour.json");
  EXPECT_EQ(names_of(kept.plan.views), names_of(poses.plan.views));
  EXPECT_EQ(names_of(kept.refused), names_of(poses.refused));
  ASSERT_EQ(kept.plan.paths.size(), poses.plan.paths.size());
  for (std::size_t i = 0; i < kept.plan.paths.size(); ++i) {
    const auto& [joints_rad, expected_rad] =
        std::pair(kept.plan.paths[i].joints_rad, poses.plan.paths[i].joints_rad);
    ASSERT_EQ(joints_rad.size(), expected_rad.size());
    for (std::size_t k = 0; k < joints_rad.size(); ++k) {
      EXPECT_LT((joints_rad[k] - expected_rad[k]).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

TEST_F(NextPoses, TellWhatStandsInTheirWaySinceTheyWereChosen) {
  const ReachedPoses poses = reached(test::kUr3Cell, 2);
  EXPECT_EQ(obstruction(cell_of(test::kUr3Cell), poses.plan), "");
  EXPECT_THAT(obstruction(cell_of(test::kUr3Cell + post_at(40.0)), poses.plan), HasSubstr("post"));
}

TEST_F(NextPoses, KeepTheCameraClearWhereItIsKnown) {
  const std::string room = "[planning]\ncamera_size_mm = [40, 40, 90]\n";
  try {
    cell_of(test::kUr3Cell + room);
    ADD_FAILURE() << "the camera's room was left out";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("planning.camera_size_mm"));
  }
  write_file(folder_ / "drawing.toml",
             "[calibration.flange_from_camera]\ntranslation_mm = [0, 50, 30]\n"
             "rotation_vector_deg = [0, 0, 0]\n");
  const PlanningCell cell =
      cell_of(test::kUr3Cell + room + "[calibration]\nfile = \"drawing.toml\"\n");
  ASSERT_EQ(cell.carried.size(), 1U);
  EXPECT_EQ(cell.carried[0].name, "camera");
}

}  // namespace
}  // namespace glint::calibrate_cell_detail

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/view_planner.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hardware/planning/clearance.h"
#include "hardware/robot/path_check.h"
#include "tests/hardware/planning/planned_cell.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

std::vector<ViewRequest> random_views(std::uint64_t count) {
  std::vector<ViewRequest> views;
  for (std::uint64_t i = 0; i < count; ++i) {
    views.push_back(random_view(i));
  }
  return views;
}

ViewRequest from_above(double x_mm, double height_mm) {
  return {.name = "above",
          .base_from_camera =
              camera_looking({x_mm, 0.0, 100.0}, {0.0, 0.0, -1.0}, height_mm, 0.5 * kPi),
          .target_mm = height_mm};
}

ViewPlan plan_of(const PlanningCell& cell, const ViewRequest& view) {
  return plan_views(cell, std::vector{view});
}

TEST(PlanViews, TakesTheCameraToEachPlannedViewAndBack) {
  const PlanningCell cell = planned_cell();
  const std::vector<ViewRequest> views = random_views(20);
  const ViewPlan plan = plan_views(cell, views, {.has_nearest = false});
  ASSERT_EQ(plan.views.size(), views.size());
  std::multiset<std::string> planned;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const PlannedView& view = plan.views[i];
    EXPECT_EQ(view.name, views[i].name);
    if (view.outcome != ViewOutcome::kPlanned) {
      EXPECT_FALSE(view.reason.empty());
      continue;
    }
    planned.insert(view.name);
    const Eigen::Isometry3d camera =
        cell.arm.arm.forward(view.joints_rad) * cell.flange_from_camera;
    EXPECT_LT(pose_difference(camera, views[i].base_from_camera).norm(), 1e-8);
    EXPECT_TRUE(view.reason.empty());
    EXPECT_GT(view.margin_mm, cell.margin_mm);
  }
  ASSERT_GE(planned.size(), 5U);
  EXPECT_DOUBLE_EQ(plan.reach_share, static_cast<double>(planned.size()) / 20.0);
  ASSERT_EQ(plan.paths.size(), planned.size() + 1);
  EXPECT_EQ(plan.paths.front().from, "above");
  EXPECT_EQ(plan.paths.back().to, "above");
  for (std::size_t i = 0; i + 1 < plan.paths.size(); ++i) {
    EXPECT_EQ(plan.paths[i].to, plan.paths[i + 1].from);
    EXPECT_EQ(plan.paths[i].joints_rad.back(), plan.paths[i + 1].joints_rad.front());
    EXPECT_EQ(planned.erase(plan.paths[i].to), 1U) << "each view once";
  }
}

TEST(PlanViews, MakesPathsThatTheRobotWillNotRefuse) {
  const PlanningCell cell = planned_cell();
  const ViewPlan plan = plan_views(cell, random_views(20), {.has_nearest = false});
  const ClearanceCheck check(cell);
  constexpr int kSamples = 200;
  for (const PlannedPath& path : plan.paths) {
    ASSERT_GE(path.joints_rad.size(), 2U);
    double duration_s = 0.0;
    for (std::size_t i = 1; i < path.joints_rad.size(); ++i) {
      const CheckedMotion motion =
          check_joint_motion(cell.arm, path.joints_rad[i - 1], path.joints_rad[i], 1.0);
      EXPECT_TRUE(motion.is_allowed()) << motion.text;
      duration_s += motion.duration_s;
      EXPECT_TRUE(check.along(path.joints_rad[i - 1], path.joints_rad[i]).is_free());
      for (int k = 0; k <= kSamples; ++k) {
        const double share = static_cast<double>(k) / kSamples;
        EXPECT_TRUE(check.at((1.0 - share) * path.joints_rad[i - 1] + share * path.joints_rad[i])
                        .is_free());
      }
    }
    EXPECT_NEAR(path.duration_s, duration_s, 1e-9 + 0.02 * duration_s);
    EXPECT_GE(path.margin_mm, plan.reach_margin_mm);
  }
  EXPECT_GE(plan.reach_margin_mm, cell.margin_mm);
}

// 500,000 for 50 views: 200,000 for 20.
TEST(PlanViews, AsksForFewDistances) {
  PlanEffort effort;
  plan_views(planned_cell(), random_views(20), {.has_nearest = false}, &effort);
  EXPECT_GT(effort.distance_queries, 1000);
  EXPECT_LT(effort.distance_queries, 500000 * 20 / 50);
}

TEST(PlanViews, SaysWhyAViewIsRefused) {
  PlanningCell cell = planned_cell();
  const ViewRequest good = from_above(300.0, 150.0);
  ASSERT_EQ(plan_of(cell, good).views[0].outcome, ViewOutcome::kPlanned);
  EXPECT_EQ(plan_of(cell, from_above(900.0, 150.0)).views[0].outcome, ViewOutcome::kUnreachable);

  PlanningCell bounded = cell;
  bounded.joint_min_rad[0] = 170.0 * kRadPerDeg;
  bounded.joint_max_rad[0] = 175.0 * kRadPerDeg;
  const ViewPlan limited = plan_of(bounded, good);
  EXPECT_EQ(limited.views[0].outcome, ViewOutcome::kJointLimit);
  EXPECT_THAT(limited.views[0].reason, HasSubstr("joint 1"));

  PlanningCell strict = cell;
  strict.min_joint_sine = 1.0;
  EXPECT_EQ(plan_of(strict, good).views[0].outcome, ViewOutcome::kSingular);

  PlanningCell narrow = cell;
  narrow.arm.limits.box_max_mm[2] = 120.0;
  EXPECT_EQ(plan_of(narrow, good).views[0].outcome, ViewOutcome::kBox);

  const ViewPlan low = plan_of(cell, from_above(300.0, 15.0));
  EXPECT_EQ(low.views[0].outcome, ViewOutcome::kCollision);
  EXPECT_THAT(low.views[0].reason, HasSubstr("part"));
}

TEST(PlanViews, NoPathIsNotUnreachable) {
  PlanningCell cell = planned_cell();
  const ViewRequest good = from_above(300.0, 150.0);
  cell.safe_positions.clear();
  const ViewPlan without = plan_of(cell, good);
  EXPECT_EQ(without.views[0].outcome, ViewOutcome::kNoPath);
  EXPECT_THAT(without.views[0].reason, HasSubstr("no safe position"));
  EXPECT_EQ(without.reach_share, 0.0);
  EXPECT_EQ(without.reach_margin_mm, 0.0);

  // From behind the arm would have to turn about its base, past walls on both sides; it keeps its
  // shape by limits of all other joints.
  cell = planned_cell();
  const JointVector there_rad = plan_of(cell, good).views[0].joints_rad;
  const JointVector home_rad = cell.safe_positions.front().joints_rad;
  constexpr double kRoom = 0.25;
  for (Eigen::Index i = 1; i < 6; ++i) {
    cell.joint_min_rad[i] = std::min(there_rad[i], home_rad[i]) - kRoom;
    cell.joint_max_rad[i] = std::max(there_rad[i], home_rad[i]) + kRoom;
  }
  cell.safe_positions = {{.name = "behind",
                          .joints_rad = cell.safe_positions.front().joints_rad +
                                        JointVector{kPi, 0.0, 0.0, 0.0, 0.0, 0.0}}};
  for (const double y_mm : {-370.0, 370.0}) {
    cell.standing.push_back(
        {.name = "wall", .mesh = box_mesh({0.0, y_mm, 390.0}, {10.0, 300.0, 780.0})});
  }
  cell.arm.limits.box_max_mm = {600.0, 500.0, 800.0};
  cell.arm.limits.box_min_mm = {-600.0, -500.0, -100.0};
  const ViewPlan walled = plan_of(cell, good);
  EXPECT_EQ(walled.views[0].outcome, ViewOutcome::kNoPath) << walled.views[0].reason;
  EXPECT_THAT(walled.views[0].reason, HasSubstr("no way from a safe position"));

  // Nor does a second safe position help that can be left for the view, and not reached from home.
  cell.safe_positions.push_back({.name = "before", .joints_rad = home_rad});
  const ViewPlan apart = plan_of(cell, good);
  EXPECT_EQ(apart.views[0].outcome, ViewOutcome::kNoPath) << apart.views[0].reason;
  EXPECT_TRUE(apart.paths.empty());
}

TEST(PlanViews, TellsTheNearestPoseOfARefusedView) {
  const PlanningCell cell = planned_cell();
  const ViewRequest low = from_above(300.0, 15.0);
  const ViewPlan plan = plan_of(cell, low);
  ASSERT_TRUE(plan.views[0].nearest_base_from_camera.has_value());
  ViewRequest nearest = low;
  nearest.base_from_camera = *plan.views[0].nearest_base_from_camera;
  EXPECT_EQ(plan_of(cell, nearest).views[0].outcome, ViewOutcome::kPlanned);
  EXPECT_LT((nearest.base_from_camera.translation() - low.base_from_camera.translation()).norm(),
            80.0);
}

TEST(PlanViews, TellsANearerPoseOfAViewThatIsOutOfReach) {
  const PlanningCell cell = planned_cell();
  const ViewRequest far = from_above(300.0, 800.0);
  const ViewPlan plan = plan_of(cell, far);
  EXPECT_EQ(plan.views[0].outcome, ViewOutcome::kUnreachable);
  ASSERT_TRUE(plan.views[0].nearest_base_from_camera.has_value());
  ViewRequest nearest = far;
  nearest.base_from_camera = *plan.views[0].nearest_base_from_camera;
  EXPECT_EQ(plan_of(cell, nearest).views[0].outcome, ViewOutcome::kPlanned);
  EXPECT_LT(nearest.base_from_camera.translation().z(), far.base_from_camera.translation().z());
}

/// A cell whose flange holds a ball 90 mm before it up to a camera that looks up from the table.
PlanningCell holding_cell() {
  PlanningCell cell = planned_cell();
  cell.standing.clear();
  cell.carried = {{.name = "part",
                   .kind = SolidBody::Kind::kCarried,
                   .link = 6,
                   .mesh = ball_mesh({0.0, 0.0, 90.0}, 40.0, 12)}};
  cell.standing.push_back({.name = "camera", .mesh = box_mesh({300.0, 0.0, 40.0}, {40, 40, 60})});
  return cell;
}

/// Of the camera at (300, 0, 70): it shall be so far before the ball's centre, from a side.
ViewRequest held_view(const Vector3d& from, double distance_mm) {
  ViewRequest view = {.name = "held", .target_mm = distance_mm};
  view.base_from_camera.translation() = Vector3d(300.0, 0.0, 70.0);
  view.flange_from_camera = camera_looking({0.0, 0.0, 90.0}, -from, distance_mm);
  return view;
}

TEST(PlanViews, HoldsThePartUpToACameraBesideTheRobot) {
  const PlanningCell cell = holding_cell();
  const std::vector<ViewRequest> views = {held_view({0.0, 0.0, 1.0}, 160.0),
                                          held_view({0.3, 0.1, 1.0}, 150.0),
                                          held_view({0.0, 0.0, 1.0}, 42.0)};
  const ViewPlan plan = plan_views(cell, views);
  for (const std::size_t i : {0U, 1U}) {
    const PlannedView& view = plan.views[i];
    ASSERT_EQ(view.outcome, ViewOutcome::kPlanned) << view.reason;
    const Eigen::Isometry3d flange = cell.arm.arm.forward(view.joints_rad);
    const Eigen::Isometry3d seen = flange.inverse() * views[i].base_from_camera;
    EXPECT_LT(pose_difference(seen, *views[i].flange_from_camera).norm(), 1e-8);
    EXPECT_LT(pose_difference(view.base_from_camera, views[i].base_from_camera).norm(), 1e-12);
  }
  // The ball's surface is 2 mm before the pinhole, the margin 5 mm.
  const PlannedView& near = plan.views[2];
  EXPECT_EQ(near.outcome, ViewOutcome::kCollision) << near.reason;
  EXPECT_FALSE(near.nearest_base_from_camera.has_value());
  ASSERT_TRUE(near.nearest_base_from_flange.has_value());
  ViewRequest nearest = views[2];
  nearest.flange_from_camera = near.nearest_base_from_flange->inverse() * nearest.base_from_camera;
  EXPECT_EQ(plan_of(cell, nearest).views[0].outcome, ViewOutcome::kPlanned);
}

TEST(PlanViews, GoesOverSafePositionsWhereTheStraightWayIsBlocked) {
  PlanningCell cell = planned_cell();
  // A wall between two low views on both sides of it.
  cell.standing.pop_back();
  cell.standing[0].mesh = box_mesh({330.0, 0.0, 110.0}, {200.0, 10.0, 220.0});
  const auto side = [](double y_mm, const char* name) {
    return ViewRequest{
        .name = name,
        .base_from_camera = camera_looking({300.0, y_mm, 0.0}, {0.0, 0.0, -1.0}, 120.0, 0.5 * kPi),
        .target_mm = 120.0};
  };
  const ViewPlan plan = plan_views(cell, std::vector{side(-190.0, "left"), side(190.0, "right")});
  ASSERT_EQ(plan.reach_share, 1.0) << plan.views[0].reason << plan.views[1].reason;
  ASSERT_EQ(plan.paths.size(), 3U);
  EXPECT_GE(plan.paths[1].joints_rad.size(), 3U) << "over a safe position";
}

TEST(PlanViews, IsTheSameEachTime) {
  const PlanningCell cell = planned_cell();
  const std::vector<ViewRequest> views = random_views(8);
  const ViewPlan first = plan_views(cell, views);
  const ViewPlan second = plan_views(cell, views);
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_EQ(first.views[i].joints_rad, second.views[i].joints_rad);
  }
  EXPECT_EQ(first.reach_margin_mm, second.reach_margin_mm);
}

}  // namespace
}  // namespace glint

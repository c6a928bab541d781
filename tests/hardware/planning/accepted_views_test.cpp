// SPDX-License-Identifier: GPL-3.0-or-later
//
// Poses that the planner accepts, judged by other means: plain distances of all triangles, the
// singular values of a Jacobian by differences, angles as numbers.
#include <gtest/gtest.h>
#include <Eigen/SVD>

#include "hardware/planning/joint_choices.h"
#include "tests/hardware/planning/plain_distance.h"
#include "tests/hardware/planning/planned_cell.h"

#ifndef GLINT_NUM_ACCEPTED
#define GLINT_NUM_ACCEPTED 300
#endif

namespace glint {
namespace {

/// Smallest singular value of the flange's motion by differences, lengths in metres.
double measure_by_differences(const Arm& arm, const JointVector& joints_rad) {
  constexpr double kStepRad = 1e-6;
  constexpr double kMetrePerMm = 1e-3;
  ArmJacobian jacobian;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const JointVector step = kStepRad * JointVector::Unit(i);
    jacobian.col(i) =
        pose_difference(arm.forward(joints_rad + step), arm.forward(joints_rad - step)) /
        (2.0 * kStepRad);
  }
  jacobian.topRows<3>() *= kMetrePerMm;
  return jacobian.jacobiSvd().singularValues().minCoeff();
}

TEST(AcceptedViews, NeitherTouchNorAreSingularNorLeaveLimits) {
  PlanningCell cell = planned_cell();
  cell.standing[0].mesh = ball_mesh({300.0, 0.0, 60.0}, 40.0, 7);
  cell.joint_min_rad[5] = -200.0 * kRadPerDeg;
  cell.joint_max_rad[5] = 200.0 * kRadPerDeg;
  const ClearanceCheck clearance(cell);
  int accepted = 0;
  for (std::uint64_t i = 0; accepted < GLINT_NUM_ACCEPTED && i < 100U * GLINT_NUM_ACCEPTED; ++i) {
    const ViewRequest view = random_view(i);
    const JointChoices choices =
        choices_of(cell, clearance, view.base_from_camera * cell.flange_from_camera.inverse());
    for (const JointChoice& choice : choices.accepted) {
      ++accepted;
      std::string nearest;
      const double plain_mm =
          plain_margin_mm(cell, clearance.bodies(), choice.turns_rad.front(), &nearest);
      EXPECT_GE(plain_mm, cell.margin_mm) << view.name << ": " << nearest;
      EXPECT_NEAR(plain_mm, choice.margin_mm, 2e-3);
      EXPECT_GT(plain_self_mm(cell, clearance.bodies(), choice.turns_rad.front(), &nearest), 0.0)
          << view.name << ": " << nearest;
      for (const JointVector& joints_rad : choice.turns_rad) {
        EXPECT_TRUE((joints_rad.array() >= cell.joint_min_rad.array()).all());
        EXPECT_TRUE((joints_rad.array() <= cell.joint_max_rad.array()).all());
        EXPECT_GE(std::abs(std::sin(joints_rad[2])), 0.05);
        EXPECT_GE(std::abs(std::sin(joints_rad[4])), 0.05);
        const Eigen::Isometry3d camera = cell.arm.arm.forward(joints_rad) * cell.flange_from_camera;
        EXPECT_LT(pose_difference(camera, view.base_from_camera).norm(), 1e-8);
      }
      EXPECT_GE(measure_by_differences(cell.arm.arm, choice.turns_rad.front()),
                cell.arm.limits.min_singularity_measure - 1e-6);
    }
  }
  EXPECT_GE(accepted, GLINT_NUM_ACCEPTED);
}

// The same comparison does fail when the planner knows less than it: without the post.
TEST(AcceptedViews, AreFoundOutWhenThePlannerDoesNotKnowABody) {
  PlanningCell blind = planned_cell();
  const PlanningCell whole = blind;
  blind.standing.pop_back();
  const ClearanceCheck clearance(blind);
  const ClearanceCheck truth(whole);
  int touching = 0;
  for (std::uint64_t i = 0; i < 300 && touching == 0; ++i) {
    const Eigen::Isometry3d flange =
        random_view(i).base_from_camera * blind.flange_from_camera.inverse();
    for (const JointChoice& choice : choices_of(blind, clearance, flange).accepted) {
      touching += truth.at(choice.turns_rad.front()).is_free() ? 0 : 1;
    }
  }
  EXPECT_GT(touching, 0);
}

}  // namespace
}  // namespace glint

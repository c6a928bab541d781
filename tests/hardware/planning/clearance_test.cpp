// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/clearance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "tests/hardware/planning/plain_distance.h"
#include "tests/hardware/planning/planned_cell.h"
#include "tests/hardware/robot/kinematics/arm_poses.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

/// The cell with nothing in it but a table.
PlanningCell empty_cell() {
  PlanningCell cell = planned_cell();
  cell.carried.clear();
  cell.standing.clear();
  return cell;
}

const JointVector& home_rad(const PlanningCell& cell) {
  return cell.safe_positions.front().joints_rad;
}

/// Joints with the flange 60 mm over the base's height, pointing down, and links above it.
JointVector low_rad(const PlanningCell& cell) {
  const Eigen::Isometry3d flange = camera_looking({330.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 60.0);
  PlanningCell open = cell;
  open.table_mm = -50.0;
  const ClearanceCheck check(open);
  for (const JointVector& joints_rad : cell.arm.arm.inverse(flange)) {
    if (check.at(joints_rad).margin_mm > 59.0) {
      return joints_rad;
    }
  }
  ADD_FAILURE() << "no such joints";
  return JointVector::Zero();
}

// The tool's tip is 20 mm below the flange, at 40 mm, its radius 30 mm: its lowest point is at
// 10 mm.
TEST(ClearanceCheck, OfATableIsTheHeightOfTheTool) {
  PlanningCell cell = empty_cell();
  const JointVector joints_rad = low_rad(cell);
  cell.table_mm = 3.0;
  const Clearance free = ClearanceCheck(cell).at(joints_rad);
  EXPECT_TRUE(free.is_free());
  EXPECT_NEAR(free.margin_mm, 7.0, 2e-3);
  cell.table_mm = 5.0;
  const Clearance refused = ClearanceCheck(cell).at(joints_rad);
  EXPECT_EQ(refused.touch, Clearance::Touch::kCollision);
  EXPECT_EQ(refused.text, "the tool comes nearer than 5 mm to the table");
}

TEST(ClearanceCheck, OfABoxBelowTheToolIsItsHeightByHand) {
  PlanningCell cell = empty_cell();
  const LinkFrames frames = cell.arm.arm.frames(home_rad(cell));
  const Vector3d tip_mm = frames[6] * cell.arm.flange_from_tcp.translation();
  const double gap_mm = 12.0;
  const Vector3d size_mm(40.0, 40.0, 10.0);
  cell.standing.push_back(
      {.name = "block",
       .mesh = box_mesh(tip_mm - Vector3d(0.0, 0.0, 30.0 + gap_mm + 5.0), size_mm)});
  EXPECT_NEAR(ClearanceCheck(cell).at(home_rad(cell)).margin_mm, gap_mm, 0.01);
  cell.standing[0].mesh = box_mesh(tip_mm, size_mm);
  EXPECT_THAT(ClearanceCheck(cell).at(home_rad(cell)).text, HasSubstr("block"));
}

TEST(ClearanceCheck, SeesWhatIsWithinABody) {
  PlanningCell cell = empty_cell();
  const LinkFrames frames = cell.arm.arm.frames(home_rad(cell));
  cell.arm.limits.box_min_mm = {-2000, -2000, -2000};
  cell.arm.limits.box_max_mm = {2000, 2000, 2000};
  cell.table_mm.reset();
  cell.standing.push_back(
      {.name = "hall", .mesh = box_mesh(frames[6].translation(), Vector3d::Constant(3000.0))});
  const Clearance within = ClearanceCheck(cell).at(home_rad(cell));
  EXPECT_EQ(within.touch, Clearance::Touch::kCollision);
  EXPECT_THAT(within.text, HasSubstr("within the hall"));
}

TEST(ClearanceCheck, OfTheBoxNamesWhatLeavesIt) {
  PlanningCell cell = planned_cell();
  cell.arm.limits.box_max_mm[0] = 200.0;
  const Clearance there = ClearanceCheck(cell).at(home_rad(cell));
  EXPECT_EQ(there.touch, Clearance::Touch::kBox);
  EXPECT_THAT(there.text, HasSubstr("leaves the box"));
}

// Joint 3 folded until the wrist is back at the upper arm.
TEST(ClearanceCheck, SeesTheArmTouchItself) {
  PlanningCell cell = empty_cell();
  JointVector joints_rad = home_rad(cell);
  const ClearanceCheck check(cell);
  EXPECT_TRUE(check.at(joints_rad).is_free());
  joints_rad[1] = -0.5 * kPi;
  joints_rad[2] = -0.95 * kPi;
  const Clearance folded = check.at(joints_rad);
  EXPECT_EQ(folded.touch, Clearance::Touch::kCollision);
  EXPECT_THAT(folded.text, HasSubstr("touches the"));
}

// Joints at random, most of them odd, in a cell with nothing but the arm and what it carries: free
// where plain distances leave the 0.5 mm that the check looks ahead.
TEST(ClearanceCheck, OfTheArmAgainstItselfAgreesWithPlainDistances) {
  PlanningCell cell = planned_cell();
  cell.standing.clear();
  cell.table_mm.reset();
  cell.arm.limits.box_min_mm = {-5000.0, -5000.0, -5000.0};
  cell.arm.limits.box_max_mm = {5000.0, 5000.0, 5000.0};
  const ClearanceCheck check(cell);
  int free = 0;
  int touching = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(5, Stream::kTest, i);
    JointVector joints_rad;
    for (double& angle : joints_rad) {
      angle = rng.uniform(-kPi, kPi);
    }
    std::string nearest;
    const double plain_mm = plain_self_mm(cell, check.bodies(), joints_rad, &nearest);
    if (std::abs(plain_mm - kLookMm) < 0.01) {
      continue;
    }
    const Clearance there = check.at(joints_rad);
    EXPECT_EQ(there.is_free(), plain_mm > kLookMm)
        << i << ": " << plain_mm << " mm, " << nearest << "; " << there.text;
    (there.is_free() ? free : touching) += 1;
  }
  EXPECT_GT(free, 50);
  EXPECT_GT(touching, 50);
}

/// Smallest plain distance at samples of a path.
double sampled_margin_mm(const PlanningCell& cell,
                         const ClearanceCheck& check,
                         const JointVector& from_rad,
                         const JointVector& to_rad,
                         int samples) {
  double least = 1e9;
  for (int i = 0; i <= samples; ++i) {
    const double share = static_cast<double>(i) / samples;
    least = std::min(least,
                     plain_margin_mm(cell, check.bodies(), from_rad + share * (to_rad - from_rad)));
  }
  return least;
}

/// The part with few triangles, so that plain distances do not take long.
PlanningCell coarse_cell() {
  PlanningCell cell = planned_cell();
  cell.standing[0].mesh = ball_mesh({300.0, 0.0, 110.0}, 90.0, 4);
  return cell;
}

TEST(ClearanceCheck, AlongAPathIsALowerBoundNearTheSmallestDistance) {
  const PlanningCell cell = coarse_cell();
  const ClearanceCheck check(cell);
  int free = 0;
  int refused = 0;
  for (std::uint64_t i = 0; i < 2000 && (free < 12 || refused < 4); ++i) {
    const JointVector from_rad = home_rad(cell) + 0.5 * random_joints(2 * i);
    const JointVector to_rad = home_rad(cell) + 0.5 * random_joints(2 * i + 1);
    if (!check.at(from_rad).is_free() || !check.at(to_rad).is_free()) {
      continue;
    }
    const Clearance path = check.along(from_rad, to_rad);
    const bool is_wanted = path.is_free() ? free < 12 : refused < 4;
    if (!is_wanted || path.touch == Clearance::Touch::kBox) {
      continue;
    }
    const double sampled_mm = sampled_margin_mm(cell, check, from_rad, to_rad, 100);
    if (path.is_free()) {
      ++free;
      EXPECT_GE(sampled_mm, path.margin_mm - 1e-6);
      EXPECT_LE(0.9 * sampled_mm - 0.5, path.margin_mm + 0.5) << sampled_mm;
    } else if (path.text.find("touches") == std::string::npos) {
      ++refused;
      EXPECT_LT(sampled_mm, cell.margin_mm + kLookMm + 5.0) << path.text;
    }
  }
  EXPECT_EQ(free, 12);
  EXPECT_EQ(refused, 4);
}

// A thin rod in the way, which samples of 200 mm apart would jump over.
TEST(ClearanceCheck, AlongAPathMissesNothingThin) {
  PlanningCell cell = empty_cell();
  JointVector to_rad = home_rad(cell);
  JointVector from_rad = to_rad;
  from_rad[0] -= 0.6;
  to_rad[0] += 0.6;
  const ClearanceCheck before(cell);
  ASSERT_TRUE(before.along(from_rad, to_rad).is_free());
  const Vector3d tip_mm =
      cell.arm.base_from_tcp(JointVector(from_rad + 0.31 * (to_rad - from_rad))).translation();
  SolidBody rod = capsule_body(tip_mm - Vector3d(0, 0, 40.0), tip_mm, 0.05);
  rod.name = "rod";
  cell.standing.push_back(rod);
  const ClearanceCheck check(cell);
  ASSERT_TRUE(check.at(from_rad).is_free());
  ASSERT_TRUE(check.at(to_rad).is_free());
  ASSERT_TRUE(check.at(0.5 * (from_rad + to_rad)).is_free());
  const Clearance path = check.along(from_rad, to_rad);
  EXPECT_EQ(path.touch, Clearance::Touch::kCollision);
  EXPECT_THAT(path.text, HasSubstr("rod"));
}

}  // namespace
}  // namespace glint

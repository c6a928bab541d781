// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/twin_cell/truth.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "core/units.h"
#include "tests/studies/twin_cell/small_cell.h"

namespace glint {
namespace {

using testing::HasSubstr;

std::string truth_error(const std::string& text) {
  try {
    truth_of(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

// A quarter turn about z takes x to y.
TEST(Truth, IsReadInDegreesAndMillimetres) {
  const Truth truth = truth_of(std::string(kSmallTruth) + "camera_rotation_deg = [0, 0, 90]\n");
  const RigidTransform pose = truth.carrier_from_camera();
  EXPECT_LT((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, 41, 30)).norm(), 1e-12);
  EXPECT_EQ(truth.scene.lights.size(), 2U);
  EXPECT_DOUBLE_EQ(truth.settings.exposure_s, 0.005);
}

TEST(Truth, NamesWhatIsNoKeyOfIt) {
  EXPECT_THAT(truth_error(std::string(kSmallTruth) + "camera_pos = 1\n"),
              HasSubstr("truth.camera_pos"));
  EXPECT_THAT(truth_error("[robot]\nhost = \"x\"\n"), HasSubstr("robot: is no table of a scene"));
  EXPECT_THAT(truth_error("[truth]\ncamera_position_mm = [1, 2]\n"),
              HasSubstr("truth.camera_position_mm"));
}

TEST(TwinCellState, HasTheSameKeyInAnyOrderOfLights) {
  EXPECT_EQ(key_of(state_above(0, {"ring", "bar"})), key_of(state_above(0, {"bar", "ring"})));
  EXPECT_NE(key_of(state_above(0, {"ring"})), key_of(state_above(0, {"bar"})));
  EXPECT_NE(key_of(state_above(0, {})), key_of(state_above(1e-5, {})));
}

// The camera looks down from 180 mm: its z axis is the scene's -z, and it stands over the origin.
TEST(SceneFromCamera, FollowsTheFlangeAndTheHandEye) {
  const Truth truth = truth_of(kSmallTruth);
  const RigidTransform pose = scene_from_camera(truth, state_above(0, {}));
  EXPECT_LT((pose.translation_mm - Eigen::Vector3d(0, 0, 180)).norm(), 1e-9);
  EXPECT_LT((pose.rotation.col(2) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-12);
}

// A camera that stands 180 mm above the base's (300, 0), looking down, and a flange that holds the
// plate up to it: the flange's axes are the base's, the plate lies 50 mm above it.
TEST(SceneFromCamera, FollowsAFlangeThatHoldsThePart) {
  Truth truth = truth_of(kSmallTruth);
  truth.settings.is_eye_to_hand = true;
  truth.settings.camera_position_mm = {300, 0, 330};
  truth.settings.camera_rotation_rad = {std::numbers::pi, 0, 0};
  truth.settings.scene_position_mm = {0, 0, 50};
  const RigidTransform base_from_flange = {.translation_mm = {290, 0, 100}};
  const RigidTransform pose = scene_from_camera(truth, {.base_from_flange = base_from_flange});
  EXPECT_LT((pose.translation_mm - Eigen::Vector3d(10, 0, 180)).norm(), 1e-9);
  EXPECT_LT((pose.rotation.col(2) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-12);
  const RigidTransform back = truth.base_from_flange(pose);
  EXPECT_LT((back.translation_mm - base_from_flange.translation_mm).norm(), 1e-9);
}

// Placements are drawn by their numbers, per axis: 200 of them have the spread that was asked for
// to three of its standard errors, 1 / sqrt(2 * 200) = 5 %.
TEST(SceneFromCamera, FollowsAPartThatIsPutDownAgain) {
  const Truth truth =
      truth_of(std::string(kSmallTruth) + "placement_mm = [0.2, 0.1, 0]\nseed = 3\n");
  const RigidTransform nominal = {.translation_mm = {300, 0, 0}};
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (int placement = 1; placement <= 200; ++placement) {
    TwinCellState state = state_above(0, {});
    state.placement = placement;
    const Eigen::Vector3d off_mm =
        (inverse(nominal) * truth.carrier_from_scene(placement)).translation_mm;
    squares += off_mm.cwiseAbs2() / 200.0;
    const RigidTransform pose = scene_from_camera(truth, state);
    EXPECT_LT((pose.translation_mm + off_mm - Eigen::Vector3d(0, 0, 180)).norm(), 1e-9);
  }
  EXPECT_NEAR(std::sqrt(squares.x()), 0.2, 0.15 * 0.2);
  EXPECT_NEAR(std::sqrt(squares.y()), 0.1, 0.15 * 0.1);
  EXPECT_EQ(squares.z(), 0.0);
  TwinCellState first = state_above(0, {});
  TwinCellState again = first;
  again.placement = 2;
  EXPECT_NE(key_of(first), key_of(again));
}

TEST(SceneFromCamera, HasTheSameErrorAtTheSamePoseAndAnotherAtAnother) {
  const Truth truth = truth_of(std::string(kSmallTruth) + "position_noise_mm = 0.1\n");
  const auto error_mm = [&](double aside_mm, const std::string& light) {
    const RigidTransform pose = scene_from_camera(truth, state_above(aside_mm, {light}));
    return Eigen::Vector3d(pose.translation_mm - Eigen::Vector3d(aside_mm, 0, 180));
  };
  EXPECT_GT(error_mm(0, "ring").norm(), 1e-4);
  EXPECT_LT(error_mm(0, "ring").norm(), 1.0);
  EXPECT_EQ(error_mm(0, "ring"), error_mm(0, "bar"));
  EXPECT_GT((error_mm(0, "ring") - error_mm(5, "ring")).norm(), 1e-4);
}

/// A UR3 with its joints as the gallery's cell has them at home.
const JointVector kJointsRad = JointVector{0.0, -100.0, 100.0, -90.0, -90.0, 0.0} * kRadPerDeg;

// To the first order the flange goes where the Jacobian takes the joints' errors: of 400 draws at
// poses that lie side by side the spread is that of the Jacobian's rows, to three of its standard
// errors, 1 / sqrt(2 * 400) = 3.5 %.
TEST(JointError, TakesTheFlangeWhereTheJacobianSays) {
  const Arm arm(ArmModel::kUr3);
  TruthSettings truth;
  truth.joint_noise_rad = 1e-4;
  constexpr int kDraws = 400;
  const RigidTransform none = {};
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    JointVector joints_rad = kJointsRad;
    joints_rad[5] += 1e-6 * i;  // another draw, the same place
    const RigidTransform off = joint_error_of(truth, arm, joints_rad, {});
    squares += (arm.forward(joints_rad).linear() * off.translation_mm).cwiseAbs2() / kDraws;
    EXPECT_FALSE(off.rotation.isApprox(none.rotation, 1e-12));
  }
  const ArmJacobian jacobian = arm.jacobian(kJointsRad);
  for (int k = 0; k < 3; ++k) {
    const double expected_mm = 1e-4 * jacobian.row(k).norm();
    EXPECT_NEAR(std::sqrt(squares[k]), expected_mm, 0.105 * expected_mm) << "xyz"[k];
  }
}

TEST(JointError, IsTheSameAtTheSamePoseAndOfItsSeed) {
  const Arm arm(ArmModel::kUr3);
  TruthSettings truth;
  EXPECT_EQ(joint_error_of(truth, arm, kJointsRad, {}).translation_mm, Eigen::Vector3d::Zero());
  truth = truth_of(std::string(kSmallTruth) + "joint_noise_deg = 0.01\n").settings;
  const RigidTransform first = joint_error_of(truth, arm, kJointsRad, {});
  EXPECT_GT(first.translation_mm.norm(), 1e-4);
  EXPECT_EQ(joint_error_of(truth, arm, kJointsRad, {}).translation_mm, first.translation_mm);
  truth.seed = 2;
  EXPECT_NE(joint_error_of(truth, arm, kJointsRad, {}).translation_mm, first.translation_mm);
}

TEST(JointError, IsAnotherUnderOtherLights) {
  const Arm arm(ArmModel::kUr3);
  TruthSettings truth;
  truth.joint_noise_rad = 1e-4;
  const auto off_mm = [&](const std::vector<std::string>& lights) {
    return joint_error_of(truth, arm, kJointsRad, lights).translation_mm;
  };
  EXPECT_EQ(off_mm({"ring"}), off_mm({"ring"}));
  EXPECT_EQ(off_mm({"ring", "bar"}), off_mm({"bar", "ring"}));
  EXPECT_GT((off_mm({"ring"}) - off_mm({"bar"})).norm(), 1e-4);
  EXPECT_GT((off_mm({"ring"}) - off_mm({"ring", "bar"})).norm(), 1e-4);
}

TEST(SceneFromCamera, FollowsTheErrorOfTheJoints) {
  const Truth truth = truth_of(kSmallTruth);
  TwinCellState state = state_above(0, {});
  state.joint_error.translation_mm = {0.5, 0, 0};  // the flange's x is the base's and the scene's
  const RigidTransform pose = scene_from_camera(truth, state);
  EXPECT_LT((pose.translation_mm - Eigen::Vector3d(0.5, 0, 180)).norm(), 1e-9);
}

}  // namespace
}  // namespace glint

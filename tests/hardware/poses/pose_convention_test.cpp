// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/pose_convention.h"

#include <gmock/gmock.h>

#include "core/rng.h"
#include "core/units.h"
#include "hardware/poses/pose_reading.h"

namespace glint {
namespace {

using testing::Contains;
using testing::HasSubstr;

WrittenPose pose_of(std::vector<double> numbers) {
  return {.numbers = std::move(numbers), .place = {.file = "p.csv", .line = 3, .column = 1}};
}

std::string convention_error(const std::vector<WrittenPose>& poses,
                             const PoseConvention& convention) {
  try {
    const PoseConvention resolved = resolved_convention(poses, convention).convention;
    for (const WrittenPose& pose : poses) {
      base_from_flange(pose, resolved);
    }
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

// A quarter turn about z takes x to y. Its quaternion is (w, x, y, z) = (s, 0, 0, s) with
// s = sqrt(1/2), its rotation vector (0, 0, pi/2).
Eigen::Isometry3d quarter_turn() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pose.translation() = Eigen::Vector3d(100, 200, 300);
  return pose;
}

TEST(PoseConvention, ReadsOnePoseInEveryNotation) {
  const double s = std::sqrt(0.5);
  const std::vector<std::pair<std::vector<double>, PoseConvention>> same = {
      {{0, -1, 0, 100, 1, 0, 0, 200, 0, 0, 1, 300}, {}},
      {{0, -1, 0, 100, 1, 0, 0, 200, 0, 0, 1, 300, 0, 0, 0, 1}, {}},
      {{0.1, 0.2, 0.3, 0, 0, s, s}, {}},
      {{100, 200, 300, s, 0, 0, s}, {.rotation = PoseRotation::kQuaternionWxyz}},
      {{0.1, 0.2, 0.3, 0, 0, kPi / 2}, {}},
      {{100, 200, 300, 90, 0, 0}, {}},
      {{100, 200, 300, 0, 0, 90}, {.rotation = PoseRotation::kEuler, .euler_order = "xyz"}},
      {{100, 200, 300, 0, 0, 90},
       {.rotation = PoseRotation::kRotationVector, .angle = PoseAngle::kDegree}},
      // The inverse: -R^T t = -(0 1 0; -1 0 0; 0 0 1) (100, 200, 300) = (-200, 100, -300).
      {{-200, 100, -300, 0, 0, -kPi / 2}, {.direction = PoseDirection::kFlangeFromBase}}};
  for (const auto& [numbers, said] : same) {
    const std::vector<WrittenPose> poses = {pose_of(numbers)};
    const ResolvedConvention resolved = resolved_convention(poses, said);
    const Eigen::Isometry3d read = base_from_flange(poses.front(), resolved.convention);
    EXPECT_TRUE(read.isApprox(quarter_turn(), 1e-12)) << testing::PrintToString(numbers);
  }
}

TEST(PoseConvention, TellsWhatItGuessedAndHowToOverruleIt) {
  const std::vector<WrittenPose> poses = {pose_of({0.1, 0.2, 0.3, 0, 0, 0, 1})};
  const std::vector<std::string> told = resolved_convention(poses, {}).told;
  EXPECT_THAT(told, Contains(HasSubstr("unit = \"m\"")));
  EXPECT_THAT(told, Contains(HasSubstr("rotation = \"quaternion_xyzw\"")));
  EXPECT_THAT(told, Contains(HasSubstr("direction = \"base_from_flange\"")));
  const PoseConvention said = {.unit = PoseUnit::kMetre,
                               .direction = PoseDirection::kBaseFromFlange,
                               .rotation = PoseRotation::kQuaternionWxyz};
  EXPECT_TRUE(resolved_convention({{pose_of({0.1, 0.2, 0.3, 1, 0, 0, 0})}}, said).told.empty());
}

TEST(PoseConvention, OffersTheOtherReadingsOfWhatWasLeftOpen) {
  const std::vector<WrittenPose> poses = {pose_of({0.1, 0.2, 0.3, 0, 0, 0, 1})};
  EXPECT_EQ(other_conventions(poses, {}).size(), 3U);  // 2 directions x 2 orders, less the guess
  const PoseConvention said = {.direction = PoseDirection::kBaseFromFlange};
  const auto others = other_conventions(poses, said);
  ASSERT_EQ(others.size(), 1U);
  EXPECT_EQ(others[0].rotation, PoseRotation::kQuaternionWxyz);
}

/// Six numbers with large angles are guessed as Euler angles; they may be a rotation vector.
TEST(PoseConvention, OffersRotationVectorsInDegrees) {
  const std::vector<WrittenPose> poses = {pose_of({100, 200, 400, 90, 20, -30})};
  const PoseConvention said = {.direction = PoseDirection::kBaseFromFlange};
  EXPECT_EQ(resolved_convention(poses, said).convention.rotation, PoseRotation::kEuler);
  const auto others = other_conventions(poses, said);
  ASSERT_EQ(others.size(), 12U);  // that and eleven other orders
  EXPECT_EQ(others[0].rotation, PoseRotation::kRotationVector);
  EXPECT_EQ(others[0].angle, PoseAngle::kDegree);
}

/// Euler angles whose order nobody told are read as zyx, which is told; the others are offered.
TEST(PoseConvention, TellsTheOrderOfEulerAnglesAndOffersTheOthers) {
  const std::vector<WrittenPose> poses = {pose_of({100, 200, 400, 90, 20, -30})};
  PoseConvention said = {.direction = PoseDirection::kBaseFromFlange,
                         .rotation = PoseRotation::kEuler,
                         .angle = PoseAngle::kDegree};
  EXPECT_THAT(resolved_convention(poses, said).told, Contains("euler_order = \"zyx\": assumed"));
  const auto others = other_conventions(poses, said);
  ASSERT_EQ(others.size(), 11U);
  EXPECT_EQ(others[0].euler_order, "xyz");
  said.written = {"euler_order"};
  EXPECT_THAT(resolved_convention(poses, said).told,
              testing::Not(Contains(HasSubstr("euler_order"))));
  EXPECT_TRUE(other_conventions(poses, said).empty());
}

TEST(PoseConvention, OffersDegreesWhereSmallAnglesWereTakenForRadians) {
  const std::vector<WrittenPose> poses = {pose_of({100, 200, 400, 5, 2, -3})};
  PoseConvention said = {.direction = PoseDirection::kBaseFromFlange,
                         .rotation = PoseRotation::kRotationVector};
  EXPECT_EQ(resolved_convention(poses, said).convention.angle, PoseAngle::kRadian);
  const auto others = other_conventions(poses, said);
  ASSERT_EQ(others.size(), 1U);
  EXPECT_EQ(others[0].angle, PoseAngle::kDegree);
  said.angle = PoseAngle::kRadian;
  EXPECT_TRUE(other_conventions(poses, said).empty());
}

TEST(PoseConvention, EulerAnglesTurnAboutTheAxesAsTheyHaveBeenTurned) {
  // "zyx" with (90, 90, 0) degrees: Rz Ry takes x to Rz (-z) = -z, y to Rz y = -x, z to Rz x = y.
  const std::vector<WrittenPose> poses = {pose_of({100, 0, 0, 90, 90, 0})};
  const PoseConvention resolved = resolved_convention(poses, {}).convention;
  const Eigen::Matrix3d rotation = base_from_flange(poses[0], resolved).linear();
  Eigen::Matrix3d expected;
  expected << 0, -1, 0, 0, 0, 1, -1, 0, 0;
  EXPECT_TRUE(rotation.isApprox(expected, 1e-12)) << rotation;
}

TEST(PoseConvention, TakesTheToolsTipOff) {
  // Along the flange's z, which is the base's: 100 mm.
  const PoseConvention said = {.flange_from_tcp = {0, 0, 100, 0, 0, 0}};
  const std::vector<WrittenPose> poses = {pose_of({0, -1, 0, 100, 1, 0, 0, 200, 0, 0, 1, 400})};
  const ResolvedConvention resolved = resolved_convention(poses, said);
  EXPECT_TRUE(base_from_flange(poses[0], resolved.convention).isApprox(quarter_turn(), 1e-12));
  EXPECT_THAT(resolved.told, Contains(HasSubstr("flange_from_tcp")));
}

TEST(PoseConvention, NamesWhatTheNumbersContradict) {
  const std::string where = "p.csv:3:1: ";
  EXPECT_THAT(convention_error({pose_of({100, 0, 0, 0, NAN, 0})}, {}),
              HasSubstr(where + "pose: number 5 is nan"));
  EXPECT_THAT(convention_error({pose_of({1e300, 0, 0, 0, 0, 0})}, {}),
              HasSubstr("number 1 is 1e+300, all must lie between -1000000 and 1000000"));
  EXPECT_THAT(convention_error({pose_of({1, 2, 3, 4, 5})}, {}),
              HasSubstr(where + "pose: has 5 numbers"));
  EXPECT_THAT(convention_error({pose_of({1, 2, 3, 0, 0, 0}), pose_of({1, 2, 3, 0, 0, 0, 1})}, {}),
              HasSubstr("has 7 numbers, the first pose has 6"));
  EXPECT_THAT(convention_error({pose_of({100, 0, 0, 0, 0, 92.5})}, {.angle = PoseAngle::kRadian}),
              HasSubstr("angle: is \"rad\", but an angle is 92.5"));
  EXPECT_THAT(convention_error({pose_of({0.4, 0, 0, 0, 0, 1})}, {.unit = PoseUnit::kMillimetre}),
              HasSubstr("unit: is \"mm\", but the flange is 0.4"));
  EXPECT_THAT(convention_error({pose_of({400, 0, 0, 0, 0, 1})}, {.unit = PoseUnit::kMetre}),
              HasSubstr("unit: is \"m\", but the flange is 400"));
  EXPECT_THAT(
      convention_error({pose_of({400, 0, 0, 0, 0, 1})}, {.rotation = PoseRotation::kMatrix}),
      HasSubstr("rotation: is \"matrix\", which needs 12 or 16 numbers"));
  EXPECT_THAT(convention_error({pose_of({1, 0, 0, 100, 0, 1.1, 0, 0, 0, 0, 1, 0})}, {}),
              HasSubstr("its matrix is no rotation: rows times rows differ from 1 by 0.21"));
  EXPECT_THAT(convention_error({pose_of({1, 0, 0, 100, 0, 1, 0, 0, 0, 0, -1, 0})}, {}),
              HasSubstr("a mirror"));
  EXPECT_THAT(convention_error({pose_of({1, 0, 0, 100, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1})}, {}),
              HasSubstr("last row"));
  EXPECT_THAT(convention_error({pose_of({400, 0, 0, 0, 0, 0.5, 0.5})}, {}),
              HasSubstr("its quaternion has the length 0.7071"));
}

TEST(PoseConvention, AllNotationsAgreeForRandomPoses) {
  Rng rng(7, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Quaterniond q =
        Eigen::Quaterniond(rng.normal(), rng.normal(), rng.normal(), rng.normal()).normalized();
    const Eigen::Matrix3d r = q.toRotationMatrix();
    const Eigen::AngleAxisd a(q);
    const Eigen::Vector3d v = a.angle() * a.axis();
    const Eigen::Vector3d e = r.eulerAngles(2, 1, 0) * kDegPerRad;
    const std::vector<std::pair<std::vector<double>, PoseConvention>> same = {
        {{500, 1, 2, q.x(), q.y(), q.z(), q.w()}, {}},
        {{500, 1, 2, v.x(), v.y(), v.z()},
         {.rotation = PoseRotation::kRotationVector, .angle = PoseAngle::kRadian}},
        {{500, 1, 2, e.x(), e.y(), e.z()},
         {.rotation = PoseRotation::kEuler, .angle = PoseAngle::kDegree}}};
    for (const auto& [numbers, said] : same) {
      const std::vector<WrittenPose> poses = {pose_of(numbers)};
      const PoseConvention resolved = resolved_convention(poses, said).convention;
      EXPECT_LT((base_from_flange(poses[0], resolved).linear() - r).norm(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace glint

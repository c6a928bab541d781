// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/pose_keys.h"

#include <gtest/gtest.h>

#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector3d;

// A quarter turn about z takes x to y; then 10 mm along the target's x.
TEST(PoseSettings, TurnFirstAndThenMove) {
  const RigidTransform pose = transform_of(
      {.translation_mm = {10.0, 0.0, 0.0}, .rotation_vector_rad = {0.0, 0.0, kPi / 2}});
  EXPECT_LT((pose * Vector3d(1.0, 2.0, 3.0) - Vector3d(10.0 - 2.0, 1.0, 3.0)).norm(), 1e-14);
}

TEST(PoseSettings, NoTurnIsExact) {
  const RigidTransform pose = transform_of({.translation_mm = {1.0, 2.0, 3.0}});
  EXPECT_EQ(pose.rotation, Eigen::Matrix3d::Identity());
}

TEST(PoseSettings, ComeBackFromTransforms) {
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    PoseSettings settings;
    const double length = rng.uniform(0.0, kPi - 1e-3);
    const Vector3d axis =
        Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.1, 1)).normalized();
    for (int k = 0; k < 3; ++k) {
      settings.rotation_vector_rad[static_cast<std::size_t>(k)] = length * axis[k];
      settings.translation_mm[static_cast<std::size_t>(k)] = rng.uniform(-1000, 1000);
    }
    const PoseSettings again = pose_settings(transform_of(settings));
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NEAR(again.rotation_vector_rad[k], settings.rotation_vector_rad[k], 1e-12);
      ASSERT_EQ(again.translation_mm[k], settings.translation_mm[k]);
    }
  }
}

TEST(PoseSettings, AreWrittenInDegreesAndReadBack) {
  MeasuredPoseSettings settings = {
      .pose = {.translation_mm = {1.5, -2.0, 300.25}, .rotation_vector_rad = {0.0, 0.0, kPi / 2}},
      .sigma_mm = {0.1, 0.1, 0.2},
      .sigma_rad = {0.01 * kRadPerDeg, 0.0, 0.0}};
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, settings);
  EXPECT_EQ(value_to_toml(*table.find("rotation_vector_deg")), "[0.0, 0.0, 90.0]");
  std::vector<Problem> errors;
  MeasuredPoseSettings again;
  KeyReader reader(&table, "pose", errors);
  visit_keys(reader, again);
  reader.report_unknown();
  EXPECT_TRUE(errors.empty());
  EXPECT_EQ(again.pose.rotation_vector_rad, settings.pose.rotation_vector_rad);
  EXPECT_EQ(again.sigma_rad, settings.sigma_rad);
}

TEST(PoseSettings, TellWhatIsWrongWithTheirPlace) {
  const ConfigNode root = parse_toml(
      "[pose]\ntranslation_mm = [1, 2]\nrotation_vector_deg = [0, 0, 400]\nsigma_mm = [-1, 0, 0]\n"
      "rotation_deg = [0, 0, 0]\n",
      "cell.toml");
  std::vector<Problem> errors;
  MeasuredPoseSettings settings;
  KeyReader reader(root.find("pose"), "pose", errors);
  visit_keys(reader, settings);
  reader.report_unknown();
  ASSERT_EQ(errors.size(), 4U);
  EXPECT_EQ(errors[0].message(),
            "cell.toml:2:1: pose.translation_mm: must be an array of 3 numbers");
  EXPECT_EQ(errors[1].key, "pose.rotation_vector_deg");
  EXPECT_EQ(errors[2].key, "pose.sigma_mm");
  EXPECT_EQ(errors[3].kind, Problem::Kind::kUnknownKey);
}

}  // namespace
}  // namespace glint

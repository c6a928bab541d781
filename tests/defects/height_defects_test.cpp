// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/height_defects.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace glint {
namespace {

Part small_plate() {
  return build_part({.shape = PartSettings::Shape::kPlate,
                     .length_mm = 60.0,
                     .width_mm = 40.0,
                     .thickness_mm = 2.0});
}

TEST(HeightDefects, DentsGoInwardsAndBumpsOutwards) {
  const Part part = small_plate();
  const Bvh bvh(part.mesh);
  const DefectGroup dent = {.type = DefectGroup::Type::kDent, .height_mm = 0.004};
  const DefectGroup bump = {.type = DefectGroup::Type::kBump, .height_mm = 0.004};
  EXPECT_DOUBLE_EQ(make_features("dent", dent, part, bvh, 0)[0].height_mm, -0.004);
  EXPECT_DOUBLE_EQ(make_features("bump", bump, part, bvh, 0)[0].height_mm, 0.004);
}

// A dent 0.8 mm across has sigma 0.2 mm; 1.6 um deep its steepest slope is
// 0.0016 / (0.2 * sqrt(e)) = 4.85 mrad.
TEST(HeightDefects, SizesFollowTheirDefinitions) {
  const Part part = small_plate();
  const Bvh bvh(part.mesh);
  const DefectGroup group = {
      .x_mm = {5.0, -7.0}, .y_mm = {1.0, 2.0}, .height_mm = 0.0016, .diameter_mm = 0.8};
  const auto features = make_features("pits", group, part, bvh, 4);
  ASSERT_EQ(features.size(), 2U);
  EXPECT_EQ(features[1].label, "pits_2");
  EXPECT_EQ(features[1].id, 5);
  EXPECT_LT((features[1].centre_mm - Eigen::Vector3d(-7.0, 2.0, 1.0)).norm(), 1e-6);
  EXPECT_NEAR(features[0].max_slope_rad(), 4.852e-3, 1e-6);
}

TEST(HeightDefects, AScratchRunsAlongItsAngle) {
  const Part part = small_plate();
  const Bvh bvh(part.mesh);
  const DefectGroup group = {.type = DefectGroup::Type::kScratch, .angle_rad = kPi / 6.0};
  const HeightFeature scratch = make_features("scratch", group, part, bvh, 0)[0];
  const Eigen::Vector3d along(std::cos(kPi / 6.0), std::sin(kPi / 6.0), 0.0);
  EXPECT_LT((scratch.u_axis - along).norm(), 1e-9);
}

TEST(HeightDefects, APlaceBesideThePartIsAnError) {
  const Part part = small_plate();
  const Bvh bvh(part.mesh);
  const DefectGroup group = {.x_mm = {45.0}, .y_mm = {0.0}};
  EXPECT_THAT([&] { make_features("dent", group, part, bvh, 0); },
              ::testing::ThrowsMessage<ConfigError>(::testing::HasSubstr("beside the part")));
}

TEST(HeightDefects, XAndYMustBeAsMany) {
  const ConfigNode root = parse_toml("x_mm = [1, 2]\ny_mm = [1]\n", "d.toml");
  std::vector<std::string> errors;
  DefectGroup group;
  KeyReader reader(&root, "defects.dent", errors);
  visit_keys(reader, group);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], ::testing::StartsWith("d.toml:2:1: defects.dent.y_mm: has 1 places"));
}

}  // namespace
}  // namespace glint

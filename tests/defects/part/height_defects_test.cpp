// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/part/height_defects.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/key_writer.h"
#include "core/config/toml.h"

namespace glint {
namespace {

TEST(HeightFeature, DentsGoInwardsBumpsOutwardsAndStainsNowhere) {
  const auto height_mm = [](DefectType type) {
    return height_feature({.type = type, .depth_mm = 0.004, .diameter_mm = 0.8}, {}).height_mm;
  };
  EXPECT_DOUBLE_EQ(height_mm(DefectType::kDent), -0.004);
  EXPECT_DOUBLE_EQ(height_mm(DefectType::kPit), -0.004);
  EXPECT_DOUBLE_EQ(height_mm(DefectType::kBump), 0.004);
  EXPECT_DOUBLE_EQ(height_mm(DefectType::kStain), 0.0);
}

// A dent 0.8 mm across has sigma 0.2 mm; 1.6 um deep its steepest slope is
// 0.0016 / (0.2 * sqrt(e)) = 4.85 mrad.
TEST(HeightFeature, SizesFollowTheirDefinitions) {
  const HeightFeature feature =
      height_feature({.label = "dents_2", .id = 5, .depth_mm = 0.0016, .diameter_mm = 0.8}, {});
  EXPECT_EQ(feature.label, "dents_2");
  EXPECT_EQ(feature.id, 5);
  EXPECT_NEAR(feature.max_slope_rad(), 4.852e-3, 1e-6);
}

// Red, green and blue count a third each: (0.9 + 0.6 + 0.3) / 3 = 0.6.
TEST(HeightFeature, AStainHasItsColourInGreyAndItsRoughness) {
  const DefectGroup group = {.colour = {0.9, 0.6, 0.3}, .stain_roughness_rad = 0.02};
  const HeightFeature stain =
      height_feature({.type = DefectType::kStain, .diameter_mm = 0.8}, group);
  EXPECT_NEAR(stain.reflectance, 0.6, 1e-15);
  EXPECT_DOUBLE_EQ(stain.roughness_rad, 0.02);
  EXPECT_TRUE(stain.is_stain());
  const HeightFeature dent = height_feature({.type = DefectType::kDent, .diameter_mm = 0.8}, group);
  EXPECT_FALSE(dent.is_stain());
}

// A line of 3 mm that is 0.4 mm wide: 2.6 mm between the centres of its round ends.
TEST(HeightFeature, AScratchIsDrawnOutAlongItsPlace) {
  const Defect scratch = {.type = DefectType::kScratch,
                          .place = {.u_axis = {0.0, 1.0, 0.0}, .v_axis = {-1.0, 0.0, 0.0}},
                          .depth_mm = 0.01,
                          .length_mm = 3.0,
                          .width_mm = 0.4};
  const HeightFeature feature = height_feature(scratch, {});
  EXPECT_EQ(feature.kind, HeightFeature::Kind::kScratch);
  EXPECT_EQ(feature.u_axis, Eigen::Vector3d::UnitY());
  EXPECT_NEAR(feature.half_line_mm(), scratch.half_line_mm(), 1e-12);
  EXPECT_NEAR(scratch.half_line_mm(), 1.3, 1e-12);
}

TEST(DefectGroup, XAndYMustBeAsMany) {
  const ConfigNode root = parse_toml("x_mm = [1, 2]\ny_mm = [1]\n", "d.toml");
  std::vector<Problem> errors;
  DefectGroup group;
  KeyReader reader(&root, "defects.dent", errors);
  visit_keys(reader, group);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0].message(),
              ::testing::StartsWith("d.toml:2:1: defects.dent.y_mm: has 1 places"));
}

std::size_t most_of(const std::string& toml) {
  const ConfigNode root = parse_toml(toml, "d.toml");
  std::vector<Problem> errors;
  DefectGroup group;
  KeyReader reader(&root, "defects.dent", errors);
  visit_keys(reader, group);
  EXPECT_TRUE(errors.empty());
  ConfigNode written = ConfigNode::table();
  KeyWriter writer(written);
  visit_keys(writer, group);
  DefectGroup again;
  KeyReader rereader(&written, "defects.dent", errors);
  visit_keys(rereader, again);
  EXPECT_TRUE(errors.empty());
  EXPECT_EQ(max_defects(again, {}), max_defects(group, {})) << "every key present";
  return max_defects(group, {});
}

TEST(DefectGroup, ACountOfZeroIsNoneUnlessPlacesAreGiven) {
  EXPECT_EQ(most_of(""), 1U) << "the part's middle";
  EXPECT_EQ(most_of("height_um = 3"), 1U);
  EXPECT_EQ(most_of("count = 0"), 0U);
  EXPECT_EQ(most_of("count = 0\nx_mm = [0]\ny_mm = [0]"), 1U);
  EXPECT_EQ(most_of("count = 0\nat_mm = [0, 0, 1, 0, 0, 2]"), 2U);
  EXPECT_EQ(most_of("count = [0, 3]"), 3U);
}

TEST(DefectGroup, ARangeRunsFromSmallToLarge) {
  const ConfigNode root = parse_toml("height_um = [5, 2]\ncount = 1.5\n", "d.toml");
  std::vector<Problem> errors;
  DefectGroup group;
  KeyReader reader(&root, "defects.dent", errors);
  visit_keys(reader, group);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_THAT(errors[0].message(),
              ::testing::StartsWith("d.toml:2:1: defects.dent.count: must be a whole"));
  EXPECT_THAT(errors[1].message(),
              ::testing::StartsWith("d.toml:1:1: defects.dent.height_um: is [5, 2], must be"));
}

TEST(DefectGroup, ItsTypeFollowsFromItsName) {
  EXPECT_EQ(type_from_name("scratches"), DefectType::kScratch);
  EXPECT_EQ(type_from_name("pits"), DefectType::kPit);
  EXPECT_EQ(type_from_name("my_group"), DefectType::kDent);
}

}  // namespace
}  // namespace glint

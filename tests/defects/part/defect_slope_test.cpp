// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/part/defect_slope.h"

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

DefectGroup dent(double diameter_mm, double depth_mm, Realisation realisation) {
  DefectGroup group;
  group.realisation = realisation;
  group.diameter_mm = diameter_mm;
  group.height_mm = depth_mm;
  group.roughness = 0.0;
  group.tool_level = 5;
  return group;
}

PartSettings plate() {
  return {.shape = PartSettings::Shape::kPlate,
          .length_mm = 20.0,
          .width_mm = 20.0,
          .thickness_mm = 5.0};
}

PartSettings cylinder(double radius_mm) {
  return {.shape = PartSettings::Shape::kCylinder, .length_mm = 20.0, .radius_mm = radius_mm};
}

/// Of a part with these groups, the slopes of all its defects [mrad].
std::vector<double> slopes_mrad(const PartSettings& settings,
                                const std::vector<NamedGroup>& groups,
                                std::uint64_t seed = 1) {
  const auto part = std::make_shared<const Part>(build_part(settings));
  const auto bvh = std::make_shared<const Bvh>(part->mesh);
  const DefectMaker maker(part, bvh, groups, {}, settings.crease_rad);
  const DefectivePart made =
      maker.make(seed, [](const Defect&, const DefectGroup&) { return Realisation::kNormal; });
  const TriangleMesh& mesh = made.has_own_mesh() ? made.mesh : part->mesh;
  std::vector<double> slopes = defect_slopes_rad(made, mesh, *part, *bvh);
  for (double& slope : slopes) {
    slope *= 1e3;
  }
  return slopes;
}

double slope_mrad(const PartSettings& settings, const DefectGroup& group, std::uint64_t seed = 1) {
  return slopes_mrad(settings, {{"dent", group}}, seed).at(0);
}

// 4 mm wide and 400 um deep: a ball of (2^2 + 0.4^2) / 0.8 = 5.2 mm, tangent at the rim 2 / 4.8 =
// 0.417. Area grows as 1 - cos: 99 % of 1 - 4.8 / 5.2 = 0.0769231 is 0.0761538, acos(0.9238462) =
// 0.39276 rad. The Gaussian of that height would have 0.4 / (1 mm sqrt(e)) = 243 mrad.
TEST(DefectSlope, OfABallIsThatOfItsRim) {
  EXPECT_NEAR(slope_mrad(plate(), dent(4.0, 0.4, Realisation::kImprinted)), 392.8, 4.0);
}

// The normal of the place itself would be off by up to 0.5 / 5 = 100 mrad at the rim.
TEST(DefectSlope, IsTakenAgainstTheCurvedSurface) {
  const DefectGroup shallow = dent(1.0, 5e-3, Realisation::kImprinted);
  const double flat = slope_mrad(plate(), shallow);
  EXPECT_NEAR(flat, 1e3 * 0.995 * std::atan(0.02), 0.4);
  EXPECT_NEAR(slope_mrad(cylinder(5.0), shallow), flat, 0.6);
}

TEST(DefectSlope, OfAWallIsAtMostARightAngle) {
  const double pit = slope_mrad(plate(), dent(0.6, 2.0, Realisation::kImprinted));
  EXPECT_GT(pit, 1500.0);
  EXPECT_LE(pit, 500.0 * kPi);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    DefectGroup rough = dent(0.6, 1.0, Realisation::kImprinted);
    rough.type = DefectType::kPit;
    rough.roughness = 0.5;
    rough.tool_level = 3;
    const double slope = slope_mrad(plate(), rough, seed);
    EXPECT_GT(slope, 1000.0);
    EXPECT_LE(slope, 500.0 * kPi);
  }
}

// Deeper than half of the wall: the wall's other side is nearer than the one it lies in. A quarter
// of the dent lies beside the edge of the plate, whose sides are nearer, too.
TEST(DefectSlope, TakesNoOtherSideOfThePart) {
  for (const double facets_mm : {0.0, 2e-3}) {
    PartSettings settings = plate();
    settings.facets_mm = facets_mm;
    DefectGroup deep = dent(8.0, 4.0, Realisation::kImprinted);
    deep.wall_share = 0.9;
    // Half a ball of 4 mm: area of a zone grows as its height: 99 % have cos >= 0.01: 1560.8 mrad.
    EXPECT_NEAR(slope_mrad(settings, deep), 1560.8, 12.0);
    deep.height_mm = 3.0;
    // Ball of (16 + 9) / 6 = 4.1667 mm: cos >= 1 - 0.99 x 3 / 4.1667 = 0.2872, acos = 1.2795 rad.
    EXPECT_NEAR(slope_mrad(settings, deep), 1279.5, 13.0);
    DefectGroup beside = dent(4.0, 0.4, Realisation::kImprinted);
    beside.x_mm = {9.0};
    EXPECT_NEAR(slope_mrad(settings, beside), 392.8, 4.0);
  }
}

// h / (sigma sqrt(e)) = 0.02 / (0.25 x 1.64872) = 0.048522; its angle is 48.48 mrad.
TEST(DefectSlope, OfAHeightIsItsSteepestAngle) {
  EXPECT_NEAR(slope_mrad(plate(), dent(1.0, 0.02, Realisation::kNormal)), 48.484, 1e-3);
  EXPECT_NEAR(slope_mrad(plate(), dent(1.0, 0.02, Realisation::kDisplaced)), 48.48, 1.0);
}

TEST(DefectSlope, StainsHaveNoneAndEachDefectHasItsOwn) {
  DefectGroup stain = dent(1.0, 0.02, Realisation::kNormal);
  stain.type = DefectType::kStain;
  stain.x_mm = {5.0};
  DefectGroup two = dent(1.0, 0.02, Realisation::kImprinted);
  two.x_mm = {-5.0, 0.0};
  two.y_mm = {0.0, 0.0};
  two.tool_level = 3;
  DefectGroup flat = dent(1.0, 0.005, Realisation::kDisplaced);
  flat.y_mm = {5.0};
  const std::vector<double> slopes =
      slopes_mrad(plate(), {{"stain", stain}, {"dent", two}, {"flat", flat}});
  ASSERT_EQ(slopes.size(), 4U);
  EXPECT_EQ(slopes[0], 0.0);
  EXPECT_NEAR(slopes[1], 1e3 * 0.995 * 2.0 * std::atan(0.04), 4.0);
  EXPECT_NEAR(slopes[2], slopes[1], 1e-3);
  EXPECT_NEAR(slopes[3], 12.13, 0.15);
}

}  // namespace
}  // namespace glint

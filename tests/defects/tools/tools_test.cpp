// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/tools/tools.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "defects/boolean/imprint.h"
#include "defects/boolean/imprint_checks.h"
#include "defects/tools/round_tool.h"
#include "defects/tools/tool_noise.h"
#include "tests/defects/tools/tool_volume.h"

namespace glint {
namespace {

Defect round_defect(DefectType type, double diameter_mm, double depth_mm) {
  Defect defect;
  defect.type = type;
  defect.diameter_mm = diameter_mm;
  defect.depth_mm = depth_mm;
  defect.tool = std::string(type_name(type));
  defect.seed = 7;
  return defect;
}

/// A turned place away from the origin.
SurfacePlace turned_place() {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  return {.centre_mm = {30.0, -20.0, 110.0},
          .u_axis = turn.col(0),
          .v_axis = turn.col(1),
          .normal = turn.col(2)};
}

/// Smallest height of a mesh over the tangent plane of a place.
double lowest_over(const TriangleMesh& mesh, const SurfacePlace& place) {
  double lowest = 1e300;
  for (const Eigen::Vector3d& p : mesh.vertices_mm) {
    lowest = std::min(lowest, (p - place.centre_mm).dot(place.normal));
  }
  return lowest;
}

TEST(ToolNoise, IsSmoothAndDiffersBetweenSeedsAndChannels) {
  const ToolNoise noise(5, 0, 4, 0.5);
  EXPECT_EQ(noise({0.3, 1.4, -2.2}), ToolNoise(5, 0, 4, 0.5)({0.3, 1.4, -2.2}));
  EXPECT_NE(noise({0.3, 1.4, -2.2}), ToolNoise(6, 0, 4, 0.5)({0.3, 1.4, -2.2}));
  EXPECT_NE(noise({0.3, 1.4, -2.2}), ToolNoise(5, 1, 4, 0.5)({0.3, 1.4, -2.2}));
  // Across cell borders and signs: a step of 1e-7 moves it by a slope of at most 20.
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d p(
        std::round(rng.uniform(-5.0, 5.0)), rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0));
    const Eigen::Vector3d step(1e-7, 1e-7, -1e-7);
    EXPECT_NEAR(noise(p + step), noise(p - step), 4e-6);
  }
}

TEST(ToolNoise, StandardisedValuesHaveMeanZeroAndUnitPower) {
  std::vector<double> values = {1.0, 2.0, 3.0, 6.0};  // mean 3, squares 4 + 1 + 0 + 9 = 14
  standardise(values);
  EXPECT_NEAR(values[0], -2.0 / std::sqrt(3.5), 1e-15);
  EXPECT_NEAR(values[3], 3.0 / std::sqrt(3.5), 1e-15);
  std::vector<double> equal = {4.0, 4.0};
  standardise(equal);
  EXPECT_EQ(equal[0], 0.0);
}

// A cap of 1 mm and 0.1 mm: pi h (3 a^2 + h^2) / 6 = pi 0.1 (0.75 + 0.01) / 6 = 0.0397935 mm3.
TEST(RoundTool, ShallowDentHasTheVolumeOfACap) {
  const double exact = kPi * 0.1 * 0.76 / 6.0;
  const auto volume = [](int level) {
    return flat_cut(round_tool({.diameter_mm = 1.0, .depth_mm = 0.1, .level = level})).volume_mm3;
  };
  EXPECT_NEAR(volume(3), exact, 0.02 * exact);
  EXPECT_NEAR(volume(5), exact, 0.001 * exact);
  EXPECT_LT(volume(5), exact);  // its corners lie on the ball
}

// Deeper than its radius: half an ellipsoid, 2/3 pi a^2 h = 2/3 pi 0.25 2 = 1.0472 mm3.
TEST(RoundTool, DeepDentIsHalfAnEllipsoid) {
  const double exact = kPi / 3.0;
  const TriangleMesh tool = round_tool({.diameter_mm = 1.0, .depth_mm = 2.0, .level = 5});
  EXPECT_NEAR(flat_cut(tool).volume_mm3, exact, 0.002 * exact);
}

// (rho / a)^4 + (z / h)^4 = 1: pi a^2 h int_0^1 sqrt(1 - t^4) dt, the integral is 0.8740192.
TEST(RoundTool, PitIsASuperellipsoid) {
  const double exact = kPi * 0.25 * 0.3 * 0.8740192;
  const TriangleMesh tool =
      round_tool({.diameter_mm = 1.0, .depth_mm = 0.3, .exponent = 4.0, .level = 5});
  EXPECT_NEAR(flat_cut(tool).volume_mm3, exact, 0.005 * exact);
}

TEST(RoundTool, OpeningHasTheDiameterWithinOnePercent) {
  for (const double depth : {5e-4, 0.005, 0.1, 0.4, 0.5, 0.501, 3.0}) {
    SCOPED_TRACE(depth);
    const TriangleMesh tool = round_tool({.diameter_mm = 1.0, .depth_mm = depth});
    EXPECT_NEAR(2.0 * std::sqrt(flat_cut(tool).opening_mm2 / kPi), 1.0, 0.01);
    EXPECT_EQ(lowest_z_mm(tool), -depth);
    EXPECT_GE(bounding_box(tool).max_mm.z(), 0.25);
    EXPECT_LT(bounding_box(tool).size_mm().x(), 1.3);
  }
}

TEST(RoundTool, HasAboutTwentyTimesFourToTheLevelTriangles) {
  for (int level = 2; level <= 5; ++level) {
    const double wanted = 20.0 * std::pow(4.0, level);
    const auto count = static_cast<double>(round_tool({.level = level}).num_triangles());
    EXPECT_NEAR(count, wanted, 0.06 * wanted) << level;
  }
  EXPECT_EQ(round_tool({.level = 3}).num_triangles(), 1248U);  // 6 * 13^2 + 18 * 13
}

// The noise scales distances from the axis by the same factor as all others; the smooth tool has
// the same points in the same order.
TEST(RoundTool, RoughnessIsTheRmsOfTheNoise) {
  const RoundTool smooth = {.diameter_mm = 1.0, .depth_mm = 0.3, .level = 4};
  RoundTool rough = smooth;
  rough.roughness = 0.1;
  rough.seed = 3;
  const TriangleMesh a = round_tool(smooth);
  const TriangleMesh b = round_tool(rough);
  double squares = 0.0;
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 1; i + 1 < a.vertices_mm.size() - 28 * 6; ++i) {
    const double factor = b.vertices_mm[i].head<2>().norm() / a.vertices_mm[i].head<2>().norm();
    sum += factor - 1.0;
    squares += (factor - 1.0) * (factor - 1.0);
    ++count;
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.1, 0.002);
  EXPECT_NEAR(sum / count, 0.0, 0.002);
  EXPECT_EQ(lowest_z_mm(b), -0.3);
}

TEST(RoundTool, IsSoundForAThousandRandomShapes) {
  Rng rng(11, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const RoundTool shape = {.diameter_mm = 0.05 * std::pow(100.0, rng.uniform()),
                             .depth_mm = 5e-4 * std::pow(2e4, rng.uniform()),
                             .exponent = rng.uniform() < 0.5 ? 2.0 : 4.0,
                             .roughness = 0.75 * rng.uniform(),
                             .noise_gain = rng.uniform(0.3, 0.8),
                             .level = 1 + i % 3,
                             .reach_mm = rng.uniform() < 0.2 ? 0.05 : 1e300,
                             .seed = rng.next_u32()};
    const TriangleMesh tool = round_tool(shape);
    ASSERT_EQ(tool_fault(tool), "") << i << ": " << shape.diameter_mm << " " << shape.depth_mm;
    ASSERT_EQ(lowest_z_mm(tool), -shape.depth_mm) << i;
    ASSERT_GT(bounding_box(tool).max_mm.z(), 0.0) << i;
  }
}

TEST(RoundTool, IsSoundAtTheEndsOfTheRanges) {
  for (const double depth : {1e-7, 5e-4, 0.05, 5.0, 100.0}) {
    for (const double diameter : {1e-3, 0.05, 5.0, 1000.0}) {
      for (const double roughness : {0.0, 0.15, 0.5}) {
        const TriangleMesh tool = round_tool(
            {.diameter_mm = diameter, .depth_mm = depth, .roughness = roughness, .seed = 3});
        EXPECT_EQ(tool_fault(tool), "") << depth << " in " << diameter;
      }
    }
  }
}

TEST(ToolCollection, DentEndsAtItsDepthHoweverItIsTurnedAndTilted) {
  const ToolCollection tools("dents", {.roughness = 0.15});
  Rng rng(2, Stream::kTest, 0);
  for (int i = 0; i < 200; ++i) {
    Defect defect = round_defect(i % 2 == 0 ? DefectType::kDent : DefectType::kPit,
                                 rng.uniform(0.1, 2.0),
                                 rng.uniform(1e-3, 0.5));
    defect.place = turned_place();
    defect.tilt_rad = rng.uniform(0.0, 0.78);
    defect.tilt_direction_rad = rng.uniform(-kPi, kPi);
    defect.seed = rng.next_u32();
    const TriangleMesh tool = tools.tool(defect);
    EXPECT_NEAR(lowest_over(tool, defect.place), -defect.depth_mm, 1e-12);
    EXPECT_EQ(tool_fault(tool), "") << i;
  }
}

TEST(ToolCollection, TiltKeepsOpeningAndVolumeAndMovesTheBottom) {
  const ToolCollection tools("dents", {.roughness = 0.0, .tool_level = 4});
  Defect defect = round_defect(DefectType::kDent, 1.0, 0.4);
  const FlatCut upright = flat_cut(tools.tool(defect));
  defect.tilt_rad = 0.3;
  defect.tilt_direction_rad = 0.5 * kPi;
  const TriangleMesh tilted = tools.tool(defect);
  EXPECT_NEAR(flat_cut(tilted).volume_mm3, upright.volume_mm3, 1e-12);
  EXPECT_NEAR(flat_cut(tilted).opening_mm2, upright.opening_mm2, 1e-12);
  // The lowest point, 0.4 below, moves against +v by 0.4 tan(0.3).
  EXPECT_NEAR(tilted.vertices_mm[0].y(), -0.4 * std::tan(0.3), 1e-12);
}

TEST(ToolCollection, BumpIsADentUpsideDownThatStaysInTheWall) {
  const ToolCollection dents("dents", {.type = DefectType::kDent});
  const ToolCollection bumps("bumps", {.type = DefectType::kBump});
  const TriangleMesh dent = dents.tool(round_defect(DefectType::kDent, 1.0, 0.1));
  Defect defect = round_defect(DefectType::kBump, 1.0, 0.1);
  const TriangleMesh bump = bumps.tool(defect);
  EXPECT_TRUE(same_bytes(bump, upside_down(dent)));
  EXPECT_EQ(bounding_box(bump).max_mm.z(), 0.1);
  EXPECT_EQ(tool_fault(bump), "");
  EXPECT_LT(lowest_z_mm(bump), -0.2);
  defect.wall_mm = 0.1;
  EXPECT_GT(lowest_z_mm(bumps.tool(defect)), -0.1);
}

// On a ball of 50 mm the surface falls by r^2 / 100: the tool follows it.
TEST(ToolCollection, RoundToolsBendWithTheSurface) {
  const ToolCollection tools("dents", {.roughness = 0.2});
  const Defect defect = round_defect(DefectType::kDent, 2.0, 0.005);
  const TriangleMesh flat = tools.tool(defect);
  const TriangleMesh bent = tools.tool(defect, {}, {.along_per_mm = 0.02, .across_per_mm = 0.02});
  for (std::size_t i = 0; i < flat.vertices_mm.size(); ++i) {
    const Eigen::Vector3d& p = flat.vertices_mm[i];
    EXPECT_NEAR(bent.vertices_mm[i].z(), p.z() - p.head<2>().squaredNorm() / 100.0, 1e-15);
  }
  EXPECT_EQ(tool_fault(bent), "");
}

TEST(ToolCollection, BentToolsAreSoundForAThousandRandomBends) {
  Rng rng(5, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const ToolCollection tools("dents",
                               {.roughness = rng.uniform(0.0, 0.4), .tool_level = 1 + i % 3});
    Defect defect = round_defect(i % 3 == 0 ? DefectType::kPit : DefectType::kDent,
                                 rng.uniform(0.1, 2.0),
                                 1e-3 * std::pow(1e3, rng.uniform()));
    defect.place = turned_place();
    defect.tilt_rad = rng.uniform(0.0, 0.7);
    defect.seed = rng.next_u32();
    const SurfaceBend bend = {.along_per_mm = rng.uniform(-2.0, 2.0),
                              .across_per_mm = rng.uniform(-2.0, 2.0)};
    ASSERT_EQ(tool_fault(tools.tool(defect, {}, bend)), "") << i;
  }
}

TEST(ToolCollection, SameDefectSameBytesOtherSeedOtherTool) {
  const ToolCollection tools("dents", {});
  Defect defect = round_defect(DefectType::kDent, 1.0, 0.05);
  const TriangleMesh first = tools.tool(defect);
  EXPECT_TRUE(same_bytes(first, tools.tool(defect)));
  EXPECT_TRUE(same_bytes(first, ToolCollection("others", {}).tool(defect)));
  defect.seed = 8;
  EXPECT_FALSE(same_bytes(first, tools.tool(defect)));
}

// A circle of 20 mm: the surface bends by 0.05 / mm.
TEST(PathBend, IsOneOverTheRadiusOfACircle) {
  std::vector<SurfacePathPoint> path;
  for (int i = -50; i <= 50; ++i) {
    const double turn = 0.0004 * i;
    path.push_back({.arc_mm = 20.0 * turn,
                    .point_mm = {20.0 * std::sin(turn), 0.0, 20.0 * std::cos(turn)},
                    .normal = {std::sin(turn), 0.0, std::cos(turn)},
                    .tangent = {std::cos(turn), 0.0, -std::sin(turn)}});
  }
  EXPECT_NEAR(path_bend(path), 0.05, 1e-5);
  for (SurfacePathPoint& p : path) {
    p.point_mm.z() = 20.0;
  }
  EXPECT_EQ(path_bend(path), 0.0);
}

// A plate of 10 x 10 x 3 mm with its top at z = 0 loses what lies below z = 0, and gains what lies
// above.
TEST(ToolCollection, ToolsImprintAPlateWithTheirVolume) {
  const ImprintedMesh part(box_mesh({-5.0, -5.0, -3.0}, {5.0, 5.0, 0.0}));
  for (const DefectType type : {DefectType::kDent,
                                DefectType::kPit,
                                DefectType::kScratch,
                                DefectType::kGouge,
                                DefectType::kBump}) {
    SCOPED_TRACE(type_name(type));
    const ToolCollection tools("group", {.type = type});
    Defect defect = round_defect(type, 1.0, 0.05);
    defect.length_mm = 4.0;
    defect.width_mm = 0.4;
    defect.tilt_rad = 0.2;
    const bool is_bump = type == DefectType::kBump;
    const TriangleMesh tool = tools.tool(defect);
    ImprintedMesh copy = part;
    const ImprintResult result =
        copy.imprint(tool, 1, is_bump ? ImprintOperation::kUnite : ImprintOperation::kSubtract);
    EXPECT_EQ(outcome_text(result.outcome), outcome_text(ImprintOutcome::kDone));
    const double volume = flat_cut(is_bump ? upside_down(tool) : tool).volume_mm3;
    EXPECT_NEAR(result.removed_volume_mm3, is_bump ? -volume : volume, 1e-10);
    EXPECT_EQ(result.seam_loops, 1);
  }
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/compare/compared_pair.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint {
namespace {

/// A plate of 120 x 70 px, turned by 0.2, on a black ground. Light falls on its left; beyond a line
/// it is nearly as dark as the ground.
struct PlateDrawing {
  double shift_x_px = 0.0;
  double shift_y_px = 0.0;
  double lit_to_px = 25.0;  ///< from the plate's middle
  double dark = 0.05;
  double side_from_px = 100.0;  ///< across the plate; the face that is seen beyond it has one grey
  double side = 0.05;
  double ground = 0.005;
  double noise = 0.003;
  std::uint64_t index = 0;
};

double beyond_plate(double x, double y) {
  const double u = std::cos(0.2) * x + std::sin(0.2) * y;
  const double v = std::cos(0.2) * y - std::sin(0.2) * x;
  return std::fmax(std::abs(u) - 60.0, std::abs(v) - 35.0);
}

ImageF drawn_plate(const PlateDrawing& drawing) {
  ImageF picture = drawn(200, 160, [&](double x, double y) {
    const double u = x - 100.0 - drawing.shift_x_px;
    const double v = y - 80.0 - drawing.shift_y_px;
    const double share = 0.5 * std::erfc(beyond_plate(u, v) / (std::sqrt(2.0) * 0.6));
    const double lit = 0.5 * std::erfc((u - drawing.lit_to_px) / (std::sqrt(2.0) * 2.0));
    const double across = std::cos(0.2) * v - std::sin(0.2) * u;
    const double side = 0.5 * std::erfc((drawing.side_from_px - across) / (std::sqrt(2.0) * 0.6));
    const double face = drawing.dark + 0.5 * lit;
    return drawing.ground + (0.005 - drawing.ground + face + side * (drawing.side - face)) * share;
  });
  add_normal_noise(picture, drawing.noise, drawing.index);
  return picture;
}

ImageF plate_mask() {
  return drawn(200, 160, [](double x, double y) {
    return beyond_plate(x - 100.0, y - 80.0) <= 0.0 ? 1.0 : 0.0;
  });
}

class GuidedOutlineTest : public CompareFiles {
 protected:
  /// @param has_truth  the simulated picture comes with the part's mask, as the renderer's do
  ComparedPair compare(const PlateDrawing& simulated, const PlateDrawing& real, bool has_truth) {
    ImageF mask = plate_mask();
    for (float& share : mask.values()) {
      share = share >= 0.5F ? 1.0F : 0.0F;
    }
    CompareSource first = {.name = "s", .picture = write("s.png", drawn_plate(simulated))};
    if (has_truth) {
      first.mask = write("part_mask.png", mask);
    }
    return compare_pair(
        {.simulated = first, .real = {.name = "r", .picture = write("r.png", drawn_plate(real))}},
        {});
  }
};

// The real light ends 8 px earlier on a part that lies where it should. By brightness alone the
// edge of the light is an outline, 8 px apart over a fifth of it.
TEST_F(GuidedOutlineTest, IsThePartsEvenWhereTheLightEndsElsewhere) {
  const PlateDrawing real = {.lit_to_px = 17.0, .index = 1};
  const ComparedPair by_brightness = compare({}, real, false);
  EXPECT_GT(by_brightness.geometry.distance.mean_px, 0.6);
  const ComparedPair pair = compare({}, real, true);
  EXPECT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kGuided);
  EXPECT_LT(pair.geometry.distance.mean_px, 0.1);
  EXPECT_GT(pair.geometry.distance.share, 0.8);
  EXPECT_TRUE(pair.notes.empty());
}

TEST_F(GuidedOutlineTest, FollowsThePartThatIsMoved) {
  const ComparedPair pair =
      compare({}, {.shift_x_px = 6.3, .shift_y_px = -4.4, .lit_to_px = 17.0, .index = 1}, true);
  ASSERT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kGuided);
  // Offsets along the normals of straight edges are those of the shift; beside corners the nearest
  // point is one of the other edge.
  std::vector<double> apart;
  for (const EdgeOffset& edge : pair.geometry.offsets) {
    apart.push_back(std::abs(edge.offset_px - edge.normal.dot(Eigen::Vector2d(6.3, -4.4))));
  }
  std::ranges::sort(apart);
  ASSERT_GT(apart.size(), 200U);
  // On the dark half an edge of 0.05 under noise of 0.003 is known to some 0.1 px.
  EXPECT_LT(apart[apart.size() / 2], 0.25);
  EXPECT_LT(apart[apart.size() * 7 / 10], 0.6);
}

// A dark face is seen below the bright one, and half of its lower edge is lost in noise. The whole
// outline squeezed until that edge lies on the rim of the bright face would fit more edges.
TEST_F(GuidedOutlineTest, IsNotSqueezedOntoTheRimOfABrightFace) {
  const PlateDrawing simulated = {.lit_to_px = 100.0, .side_from_px = 23.0};
  PlateDrawing real = simulated;
  real.side = 0.025;
  real.noise = 0.008;
  for (real.index = 1; real.index <= 4; ++real.index) {
    const ComparedPair pair = compare(simulated, real, true);
    ASSERT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kGuided);
    EXPECT_LT(pair.geometry.distance.mean_px, 0.3);
  }
}

// Before a bright wall no part is the brighter one: a cut finds it, and takes the dark half with it
// only about. Its edges lie where they do before a dark one.
TEST_F(GuidedOutlineTest, IsThePartsBeforeABrightGround) {
  const ComparedPair pair =
      compare({.ground = 0.9}, {.lit_to_px = 17.0, .ground = 0.9, .index = 1}, true);
  EXPECT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kGuided);
  EXPECT_LT(pair.geometry.distance.mean_px, 0.1);
  EXPECT_GT(pair.geometry.distance.share, 0.8);
  EXPECT_GT(pair.geometry.iou.value(), 0.995);
}

// Nothing is rendered behind the part; in the photograph there is a bright wall.
TEST_F(GuidedOutlineTest, HasEdgesOfTheOtherSignBeforeABrightGround) {
  const PlateDrawing simulated = {.lit_to_px = 100.0};
  PlateDrawing real = {.shift_x_px = 2.0, .lit_to_px = 100.0, .ground = 0.95, .index = 1};
  const ComparedPair pair = compare(simulated, real, true);
  ASSERT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kGuided);
  EXPECT_THAT(pair.notes, ::testing::Contains(::testing::HasSubstr("of the other sign")));
  std::vector<double> apart;
  for (const EdgeOffset& edge : pair.geometry.offsets) {
    apart.push_back(std::abs(edge.offset_px - 2.0 * edge.normal.x()));
  }
  std::ranges::sort(apart);
  ASSERT_GT(apart.size(), 200U);
  EXPECT_LT(apart[apart.size() / 2], 0.1);
}

// Both sides are found alike: equal pictures do not differ by the last bit.
TEST_F(GuidedOutlineTest, OfEqualPicturesIsTheSame) {
  for (const double noise : {0.0, 0.01}) {
    const ComparedPair pair = compare({.noise = noise}, {.noise = noise}, true);
    ASSERT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kGuided);
    EXPECT_EQ(pair.geometry.distance.mean_px, 0.0);
    EXPECT_EQ(pair.geometry.distance.max_px, 0.0);
    EXPECT_EQ(pair.geometry.iou.value(), 1.0);
  }
}

// Other noise moves edges either way, none of them more than the other way.
TEST_F(GuidedOutlineTest, IsNotDrawnAsideByNoise) {
  double sum = 0.0;
  double count = 0.0;
  for (std::uint64_t i = 1; i <= 6; ++i) {
    const ComparedPair pair = compare({.dark = 0.3}, {.dark = 0.3, .index = i}, true);
    for (const EdgeOffset& edge : pair.geometry.offsets) {
      sum += edge.offset_px;
      count += 1.0;
    }
  }
  EXPECT_NEAR(sum / count, 0.0, 0.003);
}

// The region is the part's, its dark half included, not that of what is bright.
TEST_F(GuidedOutlineTest, HasTheRegionOfTheWholePart) {
  const ComparedPair pair = compare({}, {.lit_to_px = 0.0, .index = 1}, true);
  double area = 0.0;
  for (const float share : pair.geometry.outlines.real.coverage.values()) {
    area += static_cast<double>(share);
  }
  EXPECT_NEAR(area, 120.0 * 70.0, 0.01 * 120.0 * 70.0);
  EXPECT_GT(pair.geometry.iou.value(), 0.99);
}

// Where the simulated part does not show there is no edge to look for.
TEST_F(GuidedOutlineTest, IsBrokenWhereTheSimulatedPartIsDark) {
  const ComparedPair pair = compare({.dark = 0.0}, {.dark = 0.0, .index = 1}, true);
  ASSERT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kGuided);
  for (const EdgeOffset& edge : pair.geometry.offsets) {
    EXPECT_LT(edge.at_px.x(), 100.0 + 25.0 + 10.0);
  }
  EXPECT_LT(pair.geometry.distance.mean_px, 0.1);
}

/// A strip 60 px wide that runs through the whole picture, askew by 0.1: one way only.
ImageF drawn_strip(double shift_y_px, std::uint64_t index) {
  ImageF picture = drawn(200, 160, [=](double x, double y) {
    const double across = std::cos(0.1) * (y - 80.0 - shift_y_px) - std::sin(0.1) * (x - 100.0);
    return 0.005 + 0.25 * std::erfc((std::abs(across) - 30.0) / (std::sqrt(2.0) * 0.6));
  });
  add_normal_noise(picture, 0.003, index);
  return picture;
}

// By 2 px down: across the strip that is 2 cos 0.1. How far it was moved along is nowhere to be
// seen.
TEST_F(GuidedOutlineTest, TellsNoShiftAlongAStripThatLeavesThePicture) {
  const Eigen::Vector2d along(std::cos(0.1), std::sin(0.1));
  const Eigen::Vector2d across(-along.y(), along.x());
  ImageF mask = drawn_strip(0.0, 0);
  for (float& share : mask.values()) {
    share = share >= 0.25F ? 1.0F : 0.0F;
  }
  const ComparedPair pair =
      compare_pair({.simulated = {.name = "s",
                                  .picture = write("s.png", drawn_strip(0.0, 1)),
                                  .mask = write("part_mask.png", mask)},
                    .real = {.name = "r", .picture = write("r.png", drawn_strip(2.0, 2))}},
                   {});
  ASSERT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kGuided);
  const OutlineMotion& motion = *pair.geometry.outlines.motion;
  EXPECT_GT(motion.untold.dot(along), 0.999);
  EXPECT_NEAR(motion.shift_px.dot(motion.untold), 0.0, 1e-9);
  EXPECT_NEAR(motion.shift_px.dot(across), 2.0 * std::cos(0.1), 0.05);
  EXPECT_THAT(pair.notes, ::testing::Contains(::testing::HasSubstr("is unknown, and taken as 0")));
}

// A part of another shape does not get the simulated one's outline.
TEST_F(GuidedOutlineTest, TellsWhatTheRealPartLacks) {
  ImageF real = drawn_plate({.lit_to_px = 100.0, .index = 1});
  for (int y = 0; y < real.height(); ++y) {
    for (int x = 95; x < real.width(); ++x) {
      real(x, y) = 0.005F;
    }
  }
  ImageF mask = plate_mask();
  for (float& share : mask.values()) {
    share = share >= 0.5F ? 1.0F : 0.0F;
  }
  const ComparedPair pair =
      compare_pair({.simulated = {.name = "s",
                                  .picture = write("s.png", drawn_plate({.lit_to_px = 100.0})),
                                  .mask = write("part_mask.png", mask)},
                    .real = {.name = "r", .picture = write("r.png", real)}},
                   {});
  EXPECT_LT(pair.geometry.iou.value(), 0.6);
  ASSERT_FALSE(pair.notes.empty());
}

}  // namespace
}  // namespace glint

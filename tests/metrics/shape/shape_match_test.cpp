// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/shape/shape_match.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "metrics/shape/equivalent_ellipse.h"
#include "tests/metrics/shape/rendered_shapes.h"

namespace glint {
namespace {

using test::Outline;
using test::Pose;
using test::random_outline;
using test::random_pose;
using test::rendered;
using test::Shape;
using test::thresholded;

double turn_error_deg(const ShapeMatch& match, const Pose& from, const Pose& to) {
  return std::abs(
             std::remainder(match.to_part.angle_rad - (to.angle_rad - from.angle_rad), 2.0 * kPi)) *
         kDegPerRad;
}

double scale_error(const ShapeMatch& match, const Pose& from, const Pose& to) {
  return std::abs(match.to_part.scale * from.scale_px / to.scale_px - 1.0);
}

/// Where the similarity takes a point, against where the poses take it.
double place_error_px(const ShapeMatch& match, const Pose& from, const Pose& to) {
  const Similarity& t = match.to_part;
  const double x = from.x_px - t.from_x_px;
  const double y = from.y_px - t.from_y_px;
  const double u = t.to_x_px + t.scale * (std::cos(t.angle_rad) * x - std::sin(t.angle_rad) * y);
  const double v = t.to_y_px + t.scale * (std::sin(t.angle_rad) * x + std::cos(t.angle_rad) * y);
  return std::hypot(u - to.x_px, v - to.y_px);
}

bool is_half_ellipse(double x, double y) {  // with equal second moments, see the test
  return x >= 0.0 && x * x / (1.8911 * 1.8911) + y * y <= 1.0;
}

struct Worst {
  double turn_deg = 0.0;
  double scale = 0.0;
  double place_px = 0.0;
  double overlap = 1.0;
  int count = 0;

  void add(const ShapeMatch& match, const Pose& from, const Pose& to) {
    turn_deg = std::max(turn_deg, turn_error_deg(match, from, to));
    scale = std::max(scale, scale_error(match, from, to));
    place_px = std::max(place_px, place_error_px(match, from, to));
    overlap = std::min(overlap, match.overlap);
    ++count;
  }
};

TEST(MatchShapes, FindRandomOutlinesWithinAFifthOfADegreeAndAFifthOfAPercent) {
  Worst by_coverage;
  Worst by_mask;
  for (std::uint64_t i = 0; by_coverage.count < 300; ++i) {
    Rng rng(2, Stream::kTest, i);
    const Outline outline = random_outline(rng);
    const Pose from = random_pose(rng);
    const Pose to = random_pose(rng);
    const ImageF reference = rendered(outline, from, 200, 190);
    const auto moments = moments_of(reference);
    ASSERT_TRUE(moments.has_value());
    const EquivalentEllipse ellipse = ellipse_of(*moments);
    if (ellipse.elongation < 0.03 || std::abs(ellipse.skewness) < 0.03) {
      continue;
    }
    const ImageF part = rendered(outline, to, 200, 190);
    const auto match = match_shapes(reference, part);
    ASSERT_TRUE(match.has_value());
    EXPECT_EQ(match->rule, RotationRule::kSkewness);
    by_coverage.add(*match, from, to);
    if (i % 3 == 0) {
      const auto coarse = match_shapes(thresholded(reference), thresholded(part));
      ASSERT_TRUE(coarse.has_value());
      by_mask.add(*coarse, from, to);
    }
  }
  for (const auto& [name, worst] : {std::pair("coverage", by_coverage), {"mask", by_mask}}) {
    RecordProperty(std::string(name) + "_turn_deg", std::to_string(worst.turn_deg));
    RecordProperty(std::string(name) + "_scale", std::to_string(worst.scale));
    RecordProperty(std::string(name) + "_place_px", std::to_string(worst.place_px));
    RecordProperty(std::string(name) + "_overlap", std::to_string(worst.overlap));
  }
  EXPECT_LT(by_coverage.turn_deg, 0.2);
  EXPECT_LT(by_coverage.scale, 0.002);
  EXPECT_LT(by_coverage.place_px, 0.02);
  EXPECT_GT(by_coverage.overlap, 0.98);
  EXPECT_LT(by_mask.turn_deg, 0.8);  // radii of 35 to 55 px, edges known to half a pixel
  EXPECT_LT(by_mask.scale, 0.003);
}

// What a silhouette is: pixels in or out, of a part that fills its picture.
TEST(MatchShapes, FindMasksOfLargePartsAsWell) {
  Worst worst;
  for (std::uint64_t i = 0; worst.count < 8; ++i) {
    Rng rng(8, Stream::kTest, i);
    const Outline outline = random_outline(rng);
    Pose from = random_pose(rng);
    Pose to = random_pose(rng);
    for (Pose* pose : {&from, &to}) {
      *pose = {3.0 * pose->x_px, 3.0 * pose->y_px, pose->angle_rad, 3.0 * pose->scale_px};
    }
    const auto match = match_shapes(thresholded(rendered(outline, from, 600, 570)),
                                    thresholded(rendered(outline, to, 600, 570)));
    ASSERT_TRUE(match.has_value());
    if (match->rule == RotationRule::kSkewness) {
      worst.add(*match, from, to);
    }
  }
  RecordProperty("turn_deg", std::to_string(worst.turn_deg));
  RecordProperty("scale", std::to_string(worst.scale));
  EXPECT_LT(worst.turn_deg, 0.2);
  EXPECT_LT(worst.scale, 0.0005);
  EXPECT_LT(worst.place_px, 0.1);
}

// Weak third moment along the long axis, but lopsided across it: only the overlap tells.
TEST(MatchShapes, SettleHalfTurnsByTheOverlapWhereTheThirdMomentIsWeak) {
  const Shape half_disc = [](double x, double y) { return x >= 0.0 && x * x + y * y <= 1.0; };
  for (std::uint64_t i = 0; i < 40; ++i) {
    Rng rng(3, Stream::kTest, i);
    const Pose from = random_pose(rng);
    const Pose to = random_pose(rng);
    const auto match =
        match_shapes(rendered(half_disc, from, 200, 190), rendered(half_disc, to, 200, 190));
    ASSERT_TRUE(match.has_value());
    EXPECT_EQ(match->rule, RotationRule::kOverlap);
    EXPECT_LT(turn_error_deg(*match, from, to), 0.2);
    EXPECT_GT(match->overlap, 0.97);
  }
}

TEST(MatchShapes, SayThatEitherWayFits) {
  const Shape rectangle = [](double x, double y) {
    return std::abs(x) <= 1.0 && std::abs(y) <= 0.6;
  };
  const Pose from{.x_px = 100.0, .y_px = 95.0, .angle_rad = 0.3, .scale_px = 50.0};
  const Pose to{.x_px = 90.0, .y_px = 99.0, .angle_rad = 0.9, .scale_px = 40.0};
  const auto match =
      match_shapes(rendered(rectangle, from, 200, 190), rendered(rectangle, to, 200, 190));
  ASSERT_TRUE(match.has_value());
  EXPECT_EQ(match->rule, RotationRule::kEitherWay);
  EXPECT_FALSE(warning(match->rule).empty());
  EXPECT_NEAR(std::remainder(match->to_part.angle_rad - 0.6, kPi), 0.0, 0.2 * kRadPerDeg);
}

TEST(MatchShapes, SayThatARoundShapeHasNoRotation) {
  const Shape disc = [](double x, double y) { return x * x + y * y <= 1.0; };
  const Shape triangle = [](double x, double y) {  // equilateral: turns by 120 degrees fit too
    return y <= 0.5 && y >= std::sqrt(3.0) * std::abs(x) - 1.0;
  };
  for (const Shape& shape : {disc, triangle}) {
    const Pose from{.x_px = 100.0, .y_px = 95.0, .angle_rad = 0.3, .scale_px = 50.0};
    const Pose to{.x_px = 90.25, .y_px = 99.5, .angle_rad = 0.9, .scale_px = 40.0};
    const auto match = match_shapes(rendered(shape, from, 200, 190), rendered(shape, to, 200, 190));
    ASSERT_TRUE(match.has_value());
    EXPECT_EQ(match->rule, RotationRule::kNone);
    EXPECT_FALSE(warning(match->rule).empty());
    EXPECT_EQ(match->to_part.angle_rad, 0.0);
    EXPECT_LT(scale_error(*match, from, to), 0.002);
    EXPECT_LT(place_error_px(*match, from, {to.x_px, to.y_px, from.angle_rad, to.scale_px}), 0.05);
  }
}

// Half an ellipse with x axis 1 / sqrt(4 (1/4 - (4 / 3 pi)^2)) = 1.8911 times y: xx = yy.
TEST(MatchShapes, TurnRoundShapesByTheirThirdMoments) {
  for (std::uint64_t i = 0; i < 40; ++i) {
    Rng rng(4, Stream::kTest, i);
    Pose from = random_pose(rng);
    Pose to = random_pose(rng);
    from.scale_px *= 0.8;
    to.scale_px *= 0.8;
    const auto match = match_shapes(rendered(is_half_ellipse, from, 200, 190),
                                    rendered(is_half_ellipse, to, 200, 190));
    ASSERT_TRUE(match.has_value());
    EXPECT_EQ(match->rule, RotationRule::kThirdMoments);
    EXPECT_LT(turn_error_deg(*match, from, to), 0.2);
  }
}

TEST(MatchShapes, ShowByTheOverlapThatThePartIsAnother) {
  Rng rng(5, Stream::kTest, 0);
  const Pose pose{.x_px = 100.0, .y_px = 95.0, .angle_rad = 0.3, .scale_px = 50.0};
  const Shape bar = [](double x, double y) { return std::abs(x) <= 1.2 && std::abs(y) <= 0.2; };
  const auto match =
      match_shapes(rendered(random_outline(rng), pose, 200, 190), rendered(bar, pose, 200, 190));
  ASSERT_TRUE(match.has_value());
  EXPECT_LT(match->overlap, 0.7);
}

// The part that a reference mask marks comes to lie where rendering it there puts it.
TEST(Warped, LaysAMaskWhereItBelongs) {
  const Shape spot = [](double x, double y) { return std::hypot(x - 0.4, y + 0.3) <= 0.35; };
  for (std::uint64_t i = 0; i < 50; ++i) {
    Rng rng(6, Stream::kTest, i);
    const Pose from = random_pose(rng);
    const Pose to = random_pose(rng);
    const Similarity exact{.from_x_px = from.x_px,
                           .from_y_px = from.y_px,
                           .to_x_px = to.x_px,
                           .to_y_px = to.y_px,
                           .angle_rad = to.angle_rad - from.angle_rad,
                           .scale = to.scale_px / from.scale_px};
    const ImageF wanted = rendered(spot, to, 210, 180);
    const ImageF found = warped(rendered(spot, from, 200, 190), exact, 210, 180);
    const Mask mask = warped(thresholded(rendered(spot, from, 200, 190)), exact, 210, 180);
    double off = 0.0;
    int wrong = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      off += static_cast<double>(std::abs(found.values()[k] - wanted.values()[k]));
      wrong += (mask.values()[k] != 0) != (wanted.values()[k] >= 0.5F) ? 1 : 0;
    }
    const double rim = 2.0 * kPi * 0.35 * to.scale_px;  // in pixels
    const double growth = std::max(exact.scale, 1.0);   // of the reference's pixels
    EXPECT_LT(off, 0.32 * growth * rim);
    EXPECT_LT(wrong, 0.32 * growth * rim);
  }
}

TEST(Warped, WithoutMovementKeepsAMask) {
  Rng rng(7, Stream::kTest, 0);
  Mask mask(40, 30);
  for (unsigned char& pixel : mask.values()) {
    pixel = rng.uniform() < 0.5 ? 1 : 0;
  }
  EXPECT_EQ(warped(mask, {}, 40, 30).width(), 40);
  const Mask solid(40, 30, 1);
  EXPECT_EQ(warped(solid, {}, 40, 30), solid);
}

// Columns of 1 and 0 in turns, three of them a pixel: 2/3 and 1/3 in turns (1 and 0 if only the
// middle were looked at).
TEST(Warped, TakesTheMeanOfWhatAPixelCovers) {
  ImageF columns(91, 31);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    columns.values()[i] = i % 91 % 2 == 0 ? 1.0F : 0.0F;
  }
  const Similarity third{
      .from_x_px = 45.0, .from_y_px = 15.0, .to_x_px = 15.0, .to_y_px = 5.0, .scale = 1.0 / 3.0};
  const ImageF small = warped(columns, third, 30, 10);
  EXPECT_NEAR(small(14, 5), 2.0F / 3.0F, 0.1F);
  EXPECT_NEAR(small(15, 5), 1.0F / 3.0F, 0.1F);
}

TEST(Warped, KeepsTheAreaOfAShrunkenMask) {
  Mask mask(400, 400);
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 400; ++x) {
      mask(x, y) = (x / 2 + y / 2) % 2 == 0 && x > 50 && x < 350 ? 1 : 0;
    }
  }
  const ImageF small = warped(coverage_of(mask),
                              {.from_x_px = 200.0,
                               .from_y_px = 200.0,
                               .to_x_px = 50.0,
                               .to_y_px = 50.0,
                               .angle_rad = 0.2,
                               .scale = 0.1},
                              100,
                              100);
  double area = 0.0;
  for (const float share : small.values()) {
    area += static_cast<double>(share);
  }
  const double before = 0.5 * 299.0 * 400.0;
  EXPECT_NEAR(area, 0.01 * before, 0.03 * 0.01 * before);
}

}  // namespace
}  // namespace glint

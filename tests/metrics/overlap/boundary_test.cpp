// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/boundary.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "tests/metrics/overlap/drawn_edges.h"

namespace glint {
namespace {

// Columns 0, 0.25, 0.5, 0.75, 1, centres at 0.5 ... 4.5: the level 0.6 is reached at 2.5 + 0.4.
TEST(BoundariesAt, InterpolatesBetweenTheCentresOfPixels) {
  ImageF ramp(5, 20);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 5; ++x) {
      ramp(x, y) = 0.25F * static_cast<float>(x);
    }
  }
  const auto lines = boundaries_at(ramp, 0.6F);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_FALSE(lines[0].is_closed);
  EXPECT_EQ(lines[0].points.size(), 20U);
  for (const BoundaryPoint& point : lines[0].points) {
    EXPECT_NEAR(point.at_px.x(), 2.9, 1e-6);
    EXPECT_NEAR(point.normal.x(), -1.0, 1e-9);  // to lower values
  }
}

TEST(BoundariesAt, FollowsACircleOnceAround) {
  const auto lines = boundaries_at(drawn_disc(120, 60.3, 58.7, 40.2, 1.0), 0.4F);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].is_closed);
  double length = 0.0;
  for (std::size_t i = 0; i < lines[0].points.size(); ++i) {
    const BoundaryPoint& point = lines[0].points[i];
    const Eigen::Vector2d out = point.at_px - Eigen::Vector2d(60.3, 58.7);
    EXPECT_NEAR(out.norm(), 40.2, 0.03);
    EXPECT_GT(point.normal.dot(out.normalized()), 0.99);
    length += (lines[0].points[(i + 1) % lines[0].points.size()].at_px - point.at_px).norm();
  }
  EXPECT_NEAR(length, 2.0 * kPi * 40.2, 0.5);
}

ImageF random_greys(std::uint64_t index) {
  ImageF picture(12, 9);
  Rng rng(1, Stream::kTest, index);
  for (float& grey : picture.values()) {
    grey = static_cast<float>(rng.uniform());
  }
  return picture;
}

// Every line of a level ends at the border of the picture or nowhere.
TEST(BoundariesAt, NeverBreaksInsideAPicture) {
  int open = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    for (const Boundary& line : boundaries_at(random_greys(i), 0.5F, 3)) {
      const auto is_at_border = [](const BoundaryPoint& point) {
        return point.at_px.x() < 1.3 || point.at_px.y() < 1.3 || point.at_px.x() > 10.7 ||
               point.at_px.y() > 7.7;
      };
      if (!line.is_closed) {
        ++open;
        EXPECT_TRUE(is_at_border(line.points.front()) && is_at_border(line.points.back())) << i;
      }
    }
  }
  EXPECT_GT(open, 1000);
}

// Around a line of two points, those from which a normal is taken are one.
TEST(BoundariesAt, LinesOfFewPointsHaveNoNormalOfTheirOwn) {
  int pairs = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    for (const Boundary& line : boundaries_at(random_greys(i), 0.5F, 2)) {
      if (line.is_closed && line.points.size() == 2) {
        ++pairs;
        EXPECT_EQ(line.points[0].normal, Eigen::Vector2d::UnitX());
        EXPECT_EQ(line.points[1].normal, Eigen::Vector2d::UnitX());
      }
    }
  }
  EXPECT_GT(pairs, 0);
}

TEST(BoundariesOf, FollowsAMaskWithinHalfAPixel) {
  Mask mask(100, 100);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      mask(x, y) = std::hypot(x + 0.5 - 50.0, y + 0.5 - 50.0) < 30.0 ? 1 : 0;
    }
  }
  const auto lines = boundaries_of(mask);
  ASSERT_EQ(lines.size(), 1U);
  for (const BoundaryPoint& point : lines[0].points) {
    EXPECT_NEAR((point.at_px - Eigen::Vector2d(50.0, 50.0)).norm(), 30.0, 0.5);
  }
}

// (0.25, 0.75) lies between the centres (0.5, 0.5) ... only to the right and below: column 0 alone.
TEST(Sample, IsBilinearBetweenCentresAndConstantBeyond) {
  ImageF picture(2, 2);
  picture.values() = {0.0F, 1.0F, 2.0F, 3.0F};
  EXPECT_DOUBLE_EQ(sample(picture, {1.0, 1.0}), 1.5);
  EXPECT_DOUBLE_EQ(sample(picture, {0.25, 0.75}), 0.5);
  EXPECT_DOUBLE_EQ(sample(picture, {-5.0, 9.0}), 2.0);
}

}  // namespace
}  // namespace glint

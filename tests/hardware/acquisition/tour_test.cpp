// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/acquisition/tour.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace glint {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

JointVector at(double a, double b) {
  JointVector joints = JointVector::Zero();
  joints[0] = a;
  joints[1] = b;
  return joints;
}

Tour tour() {
  return {{.name = "home", .joints_rad = at(0, 0), .is_safe = true},
          {.name = "a", .joints_rad = at(1, 0)},
          {.name = "b", .joints_rad = at(1, 1)},
          {.name = "home", .joints_rad = at(0, 0), .is_safe = true}};
}

TEST(PlaceOn, FindsPointsAndLegs) {
  const auto point = place_on(tour(), at(1, 0.001), 0);
  ASSERT_TRUE(point.has_value());
  EXPECT_TRUE(point->is_point);
  EXPECT_EQ(point->leg, 1U);
  const auto leg = place_on(tour(), at(1.001, 0.5), 0);
  ASSERT_TRUE(leg.has_value());
  EXPECT_FALSE(leg->is_point);
  EXPECT_EQ(leg->leg, 1U);
  EXPECT_NEAR(leg->off_rad, 0.001, 1e-12);
  EXPECT_EQ(place_text(tour(), *leg), "between a and b");
}

// At (0.5, 0.3) the nearest leg is b to home, whose line is (t, t): by least squares t = 0.4, and
// each joint is 0.1 away.
TEST(PlaceOn, FindsNothingAsideOfIt) {
  EXPECT_FALSE(place_on(tour(), at(0.5, 0.3), 0).has_value());
  EXPECT_NEAR(distance_from_tour_rad(tour(), at(0.5, 0.3)), 0.1, 1e-12);
}

TEST(PlaceOn, TakesTheOneOfSeveralThatIsNearerOnTheWay) {
  EXPECT_EQ(place_on(tour(), at(0, 0), 0)->leg, 0U);
  EXPECT_EQ(place_on(tour(), at(0, 0), 2)->leg, 3U);
}

TEST(WayTo, ComesFromThePointBefore) {
  EXPECT_THAT(way_to({.leg = 0}, 2), ElementsAre(1U, 2U));
  EXPECT_THAT(way_to({.leg = 2}, 2), ElementsAre(1U, 2U));
  EXPECT_THAT(way_to({.leg = 3}, 1), ElementsAre(2U, 1U, 0U, 1U));
  EXPECT_THAT(way_to({.leg = 1, .is_point = false}, 2), ElementsAre(2U));
  EXPECT_THAT(way_to({.leg = 1, .is_point = false}, 1), ElementsAre(1U, 0U, 1U));
  EXPECT_THAT(way_to({.leg = 0}, 0), IsEmpty());
}

TEST(WayBack, EndsAtTheFirstSafePoint) {
  EXPECT_THAT(way_back(tour(), {.leg = 2}), ElementsAre(1U, 0U));
  EXPECT_THAT(way_back(tour(), {.leg = 1, .is_point = false}), ElementsAre(1U, 0U));
  EXPECT_THAT(way_back(tour(), {.leg = 3}), IsEmpty());
  EXPECT_THAT(way_back(tour(), {.leg = 0}), IsEmpty());
}

TEST(WayToSafePoint, IsTheOneOfFewerLegs) {
  EXPECT_THAT(way_to_safe_point(tour(), {.leg = 1}), ElementsAre(0U));
  EXPECT_THAT(way_to_safe_point(tour(), {.leg = 2}), ElementsAre(3U));
  EXPECT_THAT(way_to_safe_point(tour(), {.leg = 1, .is_point = false}), ElementsAre(2U, 3U))
      << "as many on as back";
  EXPECT_THAT(way_to_safe_point(tour(), {.leg = 0, .is_point = false}), ElementsAre(0U));
  EXPECT_THAT(way_to_safe_point(tour(), {.leg = 2, .is_point = false}), ElementsAre(3U));
  EXPECT_THAT(way_to_safe_point(tour(), {.leg = 0}), IsEmpty());
  EXPECT_THAT(way_to_safe_point(tour(), {.leg = 3}), IsEmpty());
  Tour open = tour();
  open.pop_back();
  EXPECT_THAT(way_to_safe_point(open, {.leg = 2}), ElementsAre(1U, 0U)) << "none is ahead";
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/wall/slot_margin.h"

#include <cmath>

#include <gtest/gtest.h>

namespace glint {
namespace {

/// Points on the line y = -y_mm ... y_mm at z = 0, one pixel each.
VisibilityBuffer points_across(double y_mm, int count) {
  VisibilityBuffer seen;
  seen.width_px = count;
  seen.height_px = 1;
  for (auto* image : {&seen.coverage, &seen.seen_x, &seen.seen_y, &seen.seen_z}) {
    *image = ImageF(count, 1);
  }
  for (int i = 0; i < count; ++i) {
    seen.coverage(i, 0) = 1.0F;
    seen.seen_y(i, 0) = static_cast<float>(-y_mm + 2.0 * y_mm * i / (count - 1));
  }
  return seen;
}

TunnelSettings round_tunnel() {
  return {.shape = TunnelSettings::Shape::kSemicylinder, .radius_mm = 100.0, .slot_mm = 24.0};
}

const Eigen::Vector3d kCameraAbove(0.0, 0.0, 400.0);

// From (10, 0) towards (0, 400): y = 10 - 10 s, z = 400 s. On the circle (10 - 10 s)^2 + (400 s)^2
// = 10^4: 160100 s^2 - 200 s - 9900 = 0, s = (200 + sqrt(40000 + 4 x 160100 x 9900)) / 320200
// = 0.249296; y = 7.50704 and 12 - y = 4.49296.
TEST(SlotMargin, MatchesAHandWorkedCircle) {
  const SlotMargin found =
      slot_margin(points_across(10.0, 21), Mask(21, 1, 1), Tunnel(round_tunnel()), kCameraAbove);
  const double s = (200.0 + std::sqrt(40000.0 + 4.0 * 160100.0 * 9900.0)) / 320200.0;
  EXPECT_TRUE(found.has_sight);
  EXPECT_NEAR(found.margin_mm, 12.0 - (10.0 - 10.0 * s), 1e-4);
  EXPECT_NEAR(std::abs(found.y_mm), 10.0 - 10.0 * s, 1e-4);
}

// Panels lying flat at z = 100, a quarter of the way: 10 - 10 / 4 = 7.5, 12 - 7.5 = 4.5.
TEST(SlotMargin, MatchesAHandWorkedCeiling) {
  const Tunnel ceiling({.shape = TunnelSettings::Shape::kFlat,
                        .base_mm = 100.0,
                        .distance_mm = 150.0,
                        .opening_rad = 3.14159265358979,
                        .panel_height_mm = 200.0,
                        .slot_mm = 24.0});
  const SlotMargin found =
      slot_margin(points_across(10.0, 21), Mask(21, 1, 1), ceiling, kCameraAbove);
  EXPECT_TRUE(found.has_sight);
  EXPECT_NEAR(found.margin_mm, 4.5, 1e-3);
}

TEST(SlotMargin, IsNegativeWhereTheWallHidesThePart) {
  TunnelSettings narrow = round_tunnel();
  narrow.slot_mm = 10.0;
  const SlotMargin found =
      slot_margin(points_across(10.0, 21), Mask(21, 1, 1), Tunnel(narrow), kCameraAbove);
  EXPECT_NEAR(found.margin_mm, 5.0 - 7.50704, 1e-3);
}

TEST(SlotMargin, CountsTheRegionOnly) {
  Mask middle(21, 1);
  middle(10, 0) = 1;  // at y = 0, straight through the slot's middle
  const SlotMargin found =
      slot_margin(points_across(10.0, 21), middle, Tunnel(round_tunnel()), kCameraAbove);
  EXPECT_NEAR(found.margin_mm, 12.0, 1e-4);
}

TEST(SlotMargin, IsHalfTheSlotWhereTheWallDoesNotBlock) {
  TunnelSettings open = round_tunnel();
  open.blocks_view = false;
  const SlotMargin found =
      slot_margin(points_across(10.0, 21), Mask(21, 1, 1), Tunnel(open), kCameraAbove);
  EXPECT_FALSE(found.has_sight);
  EXPECT_DOUBLE_EQ(found.margin_mm, 12.0);
}

// A camera below the wall's top sees the part without passing the wall.
TEST(SlotMargin, IgnoresWallBeyondTheCamera) {
  const SlotMargin found = slot_margin(points_across(10.0, 21),
                                       Mask(21, 1, 1),
                                       Tunnel(round_tunnel()),
                                       Eigen::Vector3d(0.0, 0.0, 60.0));
  EXPECT_FALSE(found.has_sight);
}

}  // namespace
}  // namespace glint

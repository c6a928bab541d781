// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel/tunnel.h"

#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Shape = TunnelSettings::Shape;

std::vector<TunnelSettings> one_of_each_shape() {
  std::vector<TunnelSettings> all;
  for (const Shape shape :
       {Shape::kFlat, Shape::kSemicylinder, Shape::kEllipse, Shape::kSuperellipse, Shape::kFree}) {
    TunnelSettings s;
    s.shape = shape;
    s.half_width_mm = 90.0;
    s.height_mm = 120.0;
    s.opening_rad = 40.0 * kRadPerDeg;
    s.control_mm = {80.0, 95.0, 130.0, 110.0, 100.0};
    s.base_mm = -5.0;
    s.slot_mm = 0.0;
    all.push_back(s);
  }
  return all;
}

TEST(TunnelSettings, NoPlaceLiesInASlotOfNoWidth) {
  EXPECT_EQ(TunnelSettings{.slot_mm = 21.0}.half_slot_mm(), 10.5);
  EXPECT_LT(TunnelSettings{.slot_mm = 0.0}.half_slot_mm(), -1e29);
  EXPECT_EQ(static_cast<float>(TunnelSettings{.slot_mm = 0.0}.half_slot_mm()), -1e30F);
}

// Straight up from (y, z) = (60, 0) inside radius 100: z = sqrt(100^2 - 60^2) = 80.
TEST(Tunnel, SemicylinderIsHitWhereTheCircleIs) {
  const Tunnel tunnel({.shape = Shape::kSemicylinder, .radius_mm = 100.0, .slot_mm = 0.0});
  const auto hit = tunnel.hit({.origin_mm = {7.0, 60.0, 0.0}, .direction = {0.0, 0.0, 1.0}});
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->t_mm, 80.0, 1e-9);
  EXPECT_NEAR(hit->point_mm.x(), 7.0, 1e-12);
  EXPECT_LT((hit->normal - Vector3d(0.0, -0.6, -0.8)).norm(), 1e-3);
  // 100 mm times the angle from the vertical, asin(0.6) = 0.6435.
  EXPECT_NEAR(hit->arc_mm, 64.35, 0.01);
}

// Panels with an opening of 90 degrees lean 45 degrees inwards from y = 60: straight up from
// y = 20 the wall is 40 mm high.
TEST(Tunnel, FlatPanelsLeanInwardsByHalfTheOpening) {
  const Tunnel tunnel({.shape = Shape::kFlat,
                       .distance_mm = 60.0,
                       .opening_rad = 90.0 * kRadPerDeg,
                       .panel_height_mm = 200.0,
                       .slot_mm = 0.0});
  const auto hit = tunnel.hit({.origin_mm = {0.0, 20.0, 0.0}, .direction = {0.0, 0.0, 1.0}});
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->t_mm, 40.0, 1e-9);
  EXPECT_NEAR(tunnel.top_mm(), 60.0, 1e-9);  // the panels end where they meet
}

TEST(Tunnel, ParallelUprightPanelsLetRaysOutAtTheTop) {
  const Tunnel tunnel({.shape = Shape::kFlat, .distance_mm = 60.0, .panel_height_mm = 100.0});
  EXPECT_FALSE(tunnel.hit({.direction = {0.0, 0.1, 1.0}}).has_value());
  EXPECT_TRUE(tunnel.hit({.direction = {0.0, 1.0, 1.0}}).has_value());
}

// Exponent 1 is a rhombus: from the middle along (1, 1) half way to each corner, at (45, 60) for
// half axes 90 and 120... the line y / 90 + z / 120 = 1 is met at y = z = 1 / (1/90 + 1/120).
TEST(Tunnel, SuperellipseOfExponentOneIsARhombus) {
  const Tunnel tunnel({.shape = Shape::kSuperellipse,
                       .half_width_mm = 90.0,
                       .height_mm = 120.0,
                       .exponent = 1.0,
                       .slot_mm = 0.0});
  const auto hit = tunnel.hit({.direction = {0.0, 1.0, 1.0}});
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->point_mm.y(), 1.0 / (1.0 / 90.0 + 1.0 / 120.0), 1e-9);
}

TEST(Tunnel, FreeCrossSectionEndsAtItsRimAndIsMirrored) {
  const Tunnel tunnel(one_of_each_shape()[4]);
  EXPECT_NEAR(tunnel.half_width_mm(), 105.0, 25.0);
  Rng rng(3, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const double angle = rng.uniform(0.02, 0.5 * kPi);
    const Vector3d right(0.3, std::cos(angle), std::sin(angle));
    const Vector3d left(0.3, -std::cos(angle), std::sin(angle));
    const auto a = tunnel.hit({.direction = right});
    const auto b = tunnel.hit({.direction = left});
    ASSERT_TRUE(a && b) << "angle " << angle;
    EXPECT_NEAR(a->t_mm, b->t_mm, 1e-9);
  }
}

TEST(Tunnel, TheSlotIsDarkOnlyAtTheTop) {
  const Tunnel tunnel({.shape = Shape::kSemicylinder, .radius_mm = 100.0, .slot_mm = 20.0});
  EXPECT_FALSE(tunnel.hit({.direction = {0.0, 0.0, 1.0}}).has_value());
  // |y| = 9.9 of 10 is still slot, 10.1 is wall.
  EXPECT_FALSE(tunnel.hit({.origin_mm = {0, 9.9, 0}, .direction = {0, 0, 1}}).has_value());
  EXPECT_TRUE(tunnel.hit({.origin_mm = {0, 10.1, 0}, .direction = {0, 0, 1}}).has_value());
}

TEST(Tunnel, ContainsAgreesWithTheOutline) {
  for (const TunnelSettings& settings : one_of_each_shape()) {
    const Tunnel tunnel(settings);
    EXPECT_TRUE(tunnel.contains(0.0, settings.base_mm + 1.0));
    EXPECT_FALSE(tunnel.contains(0.0, 1000.0));
    EXPECT_FALSE(tunnel.contains(500.0, settings.base_mm));
    for (const auto& line : tunnel.outline(1.0)) {
      for (const Vector2d& point : line) {
        const Vector2d centre(0.0, settings.base_mm);
        const Vector2d inside = centre + 0.98 * (point - centre);
        const Vector2d outside = centre + 1.02 * (point - centre);
        if (settings.shape != Shape::kFlat || point.y() > settings.base_mm + 1.0) {
          EXPECT_TRUE(tunnel.contains(inside.x(), inside.y())) << shape_name(settings.shape);
          EXPECT_FALSE(tunnel.contains(outside.x(), outside.y() + 1e-6))
              << shape_name(settings.shape);
        }
      }
    }
  }
}

TEST(Tunnel, ALevelCeilingHasItsSlotAtAnyHeight) {
  for (const double base_mm : {0.0, 10.0, 33.0, 200.0, 3000.0}) {
    const Tunnel tunnel({.shape = Shape::kFlat,
                         .base_mm = base_mm,
                         .distance_mm = 100.0,
                         .opening_rad = kPi,
                         .slot_mm = 30.0});
    const float y[2] = {10.0F, 20.0F};
    const float zero[2] = {0.0F, 0.0F};
    const float z[2] = {static_cast<float>(base_mm) - 50.0F, static_cast<float>(base_mm) - 50.0F};
    const float up[2] = {1.0F, 1.0F};
    const RayBlock rays = {.origin_x = zero,
                           .origin_y = y,
                           .origin_z = z,
                           .direction_x = zero,
                           .direction_y = zero,
                           .direction_z = up,
                           .count = 2};
    float x[2];
    float q[2];
    float gain[2];
    tunnel.hit_block(rays, x, q, gain);
    EXPECT_EQ(gain[0], 0.0F) << base_mm;
    EXPECT_EQ(gain[1], 1.0F) << base_mm;
  }
}

/// Whether a bright stripe stands at a place of the wall, seen straight up from (x, y, base).
bool is_bright(const Tunnel& tunnel, double shift_mm, double place_x_mm, double place_y_mm) {
  const std::array<float, 6> ray = {
      static_cast<float>(place_x_mm), static_cast<float>(place_y_mm), 0.0F, 0.0F, 0.0F, 1.0F};
  float x = 0.0F;
  float pattern = 0.0F;
  float gain = 0.0F;
  float radiance = 0.0F;
  tunnel.hit_block({&ray[0], &ray[1], &ray[2], &ray[3], &ray[4], &ray[5], 1}, &x, &pattern, &gain);
  add_stripes(&x, &pattern, &gain, 1, tunnel.pattern(shift_mm), 1.0F, &radiance);
  return radiance > 0.5F;
}

// docs/images/stripes_frame_0.svg: a bright stripe from 4 to 12 mm, and 4 mm further in frame 1.
TEST(Tunnel, StripesOfFrameZeroBeginAtTheOffsetAndMoveAlongX) {
  const Tunnel tunnel({.slot_mm = 0.0, .period_mm = 16.0, .duty = 0.5, .offset_mm = 4.0});
  for (const double step_mm : {0.0, 4.0}) {
    EXPECT_FALSE(is_bright(tunnel, step_mm, step_mm + 3.9, 0.0)) << step_mm;
    EXPECT_TRUE(is_bright(tunnel, step_mm, step_mm + 4.1, 0.0)) << step_mm;
    EXPECT_TRUE(is_bright(tunnel, step_mm, step_mm + 11.9, 0.0)) << step_mm;
    EXPECT_FALSE(is_bright(tunnel, step_mm, step_mm + 12.1, 0.0)) << step_mm;
  }
}

// On a wall of radius 100 mm y = 50 is 100 pi / 6 = 52.36 mm of arc from the top: stripes turned by
// 30 degrees stand 52.36 tan 30 = 30.23 mm further to -x there.
TEST(Tunnel, ObliqueStripesLeanTowardsMinusXAtPositiveY) {
  const Tunnel tunnel({.slot_mm = 0.0, .period_mm = 40.0, .orientation_rad = 30.0 * kRadPerDeg});
  EXPECT_FALSE(is_bright(tunnel, 0.0, -0.2, 0.0));
  EXPECT_TRUE(is_bright(tunnel, 0.0, 0.2, 0.0));
  EXPECT_FALSE(is_bright(tunnel, 0.0, -30.4, 50.0));
  EXPECT_TRUE(is_bright(tunnel, 0.0, -30.0, 50.0));
  EXPECT_FALSE(is_bright(tunnel, 0.0, 30.0, -50.0));
  EXPECT_TRUE(is_bright(tunnel, 0.0, 30.4, -50.0));
}

// 1e9 mm is a whole number of periods of 16 mm: nothing changes.
TEST(Tunnel, AFarOffsetKeepsItsPhase) {
  const Tunnel near({.period_mm = 16.0, .offset_mm = 3.0});
  const Tunnel far({.period_mm = 16.0, .offset_mm = 1e9 + 3.0});
  EXPECT_FLOAT_EQ(near.pattern(5.0).shift_pattern_mm, far.pattern(5.0).shift_pattern_mm);
}

TEST(TunnelKeys, SlotWiderThanTheTunnelIsAnErrorWithItsPlace) {
  const ConfigNode root = parse_toml("radius_mm = 40\nslot_mm = 90\n", "s.toml");
  std::vector<Problem> errors;
  TunnelSettings settings;
  KeyReader reader(&root, "lighting.tunnel", errors);
  visit_keys(reader, settings);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].message(),
            "s.toml:2:1: lighting.tunnel.slot_mm: is 90, must be smaller than the tunnel, which is "
            "80 mm wide");
}

}  // namespace
}  // namespace glint

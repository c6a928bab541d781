// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sizes of lights against closed forms worked by hand, and boxes against points of the surfaces.
#include "simulator/light/area/light_extent.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Shape = TunnelSettings::Shape;

LightExtent extent_of_one(const LightSettings& settings) {
  return extent_of({{.name = "light", .settings = settings}}, {}, {});
}

/// Closed forms of curves hold to a millionth: walls are polygons of 2049 points.
void expect_wall(const TunnelSettings& settings,
                 double cross_section_mm,
                 double width_mm,
                 double low_mm,
                 double high_mm) {
  const LightExtent extent = extent_of(settings, 0.0);
  EXPECT_NEAR(extent.area_mm2 / (cross_section_mm * settings.length_mm), 1.0, 1e-6);
  EXPECT_NEAR(extent.box_mm.sizes().x(), settings.length_mm, 1e-9);
  EXPECT_NEAR(extent.box_mm.sizes().y(), width_mm, 1e-4);
  EXPECT_NEAR(extent.box_mm.min().z(), low_mm, 1e-4);
  EXPECT_NEAR(extent.box_mm.max().z(), high_mm, 1e-4);
  EXPECT_EQ(extent.leds, 0);
}

// Radius 100, slot 20: the arc lacks 2 asin(0.1) of pi, and ends at height 100 cos(asin(0.1)).
TEST(ExtentOfTunnel, OfASemicylinderIsHalfACircleWithoutItsSlot) {
  const double half_slot = std::asin(0.1);
  expect_wall({.base_mm = 7.0, .radius_mm = 100.0, .length_mm = 600.0, .slot_mm = 20.0},
              100.0 * (kPi - 2.0 * half_slot),
              200.0,
              7.0,
              7.0 + 100.0 * std::cos(half_slot));
  expect_wall({.radius_mm = 100.0, .slot_mm = 0.0}, 100.0 * kPi, 200.0, 0.0, 100.0);
}

// Two upright panels of 200 mm, 120 mm apart: the slot between them takes nothing away.
TEST(ExtentOfTunnel, OfUprightPanelsIsTheirSize) {
  expect_wall({.shape = Shape::kFlat,
               .base_mm = -5.0,
               .distance_mm = 60.0,
               .panel_height_mm = 200.0,
               .slot_mm = 20.0},
              2.0 * 200.0,
              120.0,
              -5.0,
              195.0);
}

// Opened by 120 degrees, each panel leans inwards by 60: 200 mm would take it 173 mm sideways, so
// it ends at the middle plane, 100 / sin(60) long and 100 / tan(60) high. The slot of 20 mm takes
// 10 / sin(60) of each, and 10 / tan(60) of the height.
TEST(ExtentOfTunnel, OfALeaningRoofEndsAtTheSlot) {
  const double angle = kPi / 3.0;
  expect_wall({.shape = Shape::kFlat,
               .distance_mm = 100.0,
               .opening_rad = 2.0 * angle,
               .panel_height_mm = 200.0,
               .slot_mm = 20.0},
              2.0 * 90.0 / std::sin(angle),
              200.0,
              0.0,
              90.0 / std::tan(angle));
}

// With exponent 1 the wall is a gable: two straight lines from (+-120, 0) to (0, 50), 130 mm each.
// A slot of 24 mm takes a tenth of each.
TEST(ExtentOfTunnel, OfASuperellipseOfExponentOneIsAGable) {
  const TunnelSettings gable = {.shape = Shape::kSuperellipse,
                                .half_width_mm = 120.0,
                                .height_mm = 50.0,
                                .exponent = 1.0,
                                .slot_mm = 0.0};
  expect_wall(gable, 260.0, 240.0, 0.0, 50.0);
  TunnelSettings slotted = gable;
  slotted.slot_mm = 24.0;
  expect_wall(slotted, 234.0, 240.0, 0.0, 45.0);
}

// Ramanujan's second approximation of an ellipse's circumference, which for axes of 1.5 : 1 is
// right to 1e-9 (S. Ramanujan, "Modular equations and approximations to pi", 1914).
TEST(ExtentOfTunnel, OfAnEllipseIsHalfItsCircumference) {
  const double a = 150.0;
  const double b = 100.0;
  const double h = std::pow((a - b) / (a + b), 2.0);
  const double whole = kPi * (a + b) * (1.0 + 3.0 * h / (10.0 + std::sqrt(4.0 - 3.0 * h)));
  expect_wall({.shape = Shape::kEllipse, .half_width_mm = a, .height_mm = b, .slot_mm = 0.0},
              0.5 * whole,
              2.0 * a,
              0.0,
              b);
}

// Control points (-80, 0), (-40, 40), (0, 80), (40, 40), (80, 0): each half is the Bezier curve of
// (-80, 0), (-40, 40), (-20, 60), (0, 60), whose speed 3 |sum of Bernstein differences| is
// integrated by Simpson's rule here.
TEST(ExtentOfTunnel, OfAFreeCrossSectionIsItsSplinesLength) {
  const auto speed = [](double t) {
    const double y = 40.0 * (1.0 - t) * (1.0 - t) + 2.0 * 20.0 * t * (1.0 - t) + 20.0 * t * t;
    const double z = 40.0 * (1.0 - t) * (1.0 - t) + 2.0 * 20.0 * t * (1.0 - t);
    return 3.0 * std::hypot(y, z);
  };
  constexpr int kSteps = 1000;
  double half = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double weight = i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    half += weight * speed(static_cast<double>(i) / kSteps) / (3.0 * kSteps);
  }
  expect_wall(
      {.shape = Shape::kFree, .control_mm = {80.0, 80.0 / std::sqrt(2.0), 80.0}, .slot_mm = 0.0},
      2.0 * half,
      160.0,
      0.0,
      60.0);
}

// pi (40^2 - 25^2) on a plane 80 mm wide; as 24 LEDs of 5 mm on the circle of 32.5 mm:
// 24 pi 2.5^2. The LEDs nearest to the x axis stand 7.5 degrees beside it.
TEST(ExtentOfLights, OfARing) {
  const RingSettings even = {.inner_radius_mm = 25.0, .outer_radius_mm = 40.0, .height_mm = 60.0};
  const LightExtent ring = extent_of_one(even);
  EXPECT_NEAR(ring.area_mm2, kPi * (1600.0 - 625.0), 1e-9);
  EXPECT_TRUE(ring.box_mm.sizes().isApprox(Vector3d(80.0, 80.0, 0.0), 1e-9));
  EXPECT_NEAR(ring.box_mm.center().z(), 60.0, 1e-9);
  EXPECT_EQ(ring.leds, 0);
  RingSettings single = even;
  single.leds = 24;
  const LightExtent leds = extent_of_one(single);
  EXPECT_NEAR(leds.area_mm2, 24.0 * kPi * 6.25, 1e-9);
  const double reach = 32.5 * std::cos(7.5 * kRadPerDeg) + 2.5;
  EXPECT_TRUE(leds.box_mm.sizes().isApprox(Vector3d(2.0 * reach, 2.0 * reach, 0.0), 1e-9));
  EXPECT_EQ(leds.leds, 24);
}

// A half sphere of 100 mm with a hole of 60 mm: 2 pi R^2 cos(asin(0.3)), and as high as that.
TEST(ExtentOfLights, OfADome) {
  const LightExtent dome = extent_of_one(DomeSettings{.radius_mm = 100.0, .opening_mm = 60.0});
  const double height = 100.0 * std::sqrt(1.0 - 0.09);
  EXPECT_NEAR(dome.area_mm2, 2.0 * kPi * 100.0 * height, 1e-6);
  EXPECT_TRUE(dome.box_mm.sizes().isApprox(Vector3d(200.0, 200.0, height), 1e-9));
}

// 200 x 20 mm, turned by 30 degrees about its axis: 200 cos + 20 sin along x, 200 sin + 20 cos
// along y.
TEST(ExtentOfLights, OfATurnedBar) {
  BarSettings bar = {.length_mm = 200.0, .width_mm = 20.0};
  bar.placement.roll_rad = kPi / 6.0;
  bar.segments.segments = 4;
  const LightExtent extent = extent_of_one(bar);
  EXPECT_NEAR(extent.area_mm2, 4000.0, 1e-9);
  const double cosine = std::sqrt(0.75);
  EXPECT_TRUE(extent.box_mm.sizes().isApprox(
      Vector3d(200.0 * cosine + 10.0, 100.0 + 20.0 * cosine, 0.0), 1e-9));
}

TEST(ExtentOfLights, OfAMeshIsThatOfItsTriangles) {
  const MeshLoader load = [](const std::filesystem::path&) {
    return std::vector<LightTriangle>{{Vector3d(0, 0, 0), Vector3d(30, 0, 0), Vector3d(0, 40, 0)},
                                      {Vector3d(0, 0, 0), Vector3d(0, 40, 0), Vector3d(0, 0, 10)}};
  };
  const LightExtent extent =
      extent_of({{.name = "panel", .settings = MeshLightSettings{.file = "panel.stl"}}}, {}, load);
  EXPECT_NEAR(extent.area_mm2, 600.0 + 200.0, 1e-9);
  EXPECT_TRUE(extent.box_mm.sizes().isApprox(Vector3d(30.0, 40.0, 10.0), 1e-9));
}

TEST(ExtentOfLights, TogetherHaveOneBoxAndTheSumOfAreas) {
  const LightExtent both = extent_of({{.name = "ring", .settings = RingSettings{.height_mm = 50.0}},
                                      {.name = "bar", .settings = BarSettings{}},
                                      {.name = "sky", .settings = EnvironmentSettings{}}},
                                     {},
                                     {});
  EXPECT_NEAR(both.area_mm2, kPi * 975.0 + 4000.0, 1e-9);
  EXPECT_TRUE(both.box_mm.sizes().isApprox(Vector3d(200.0, 80.0, 100.0), 1e-9));
  const LightExtent sky = extent_of_one(EnvironmentSettings{});
  EXPECT_TRUE(sky.box_mm.isEmpty());
  const LightExtent all = together(both, extent_of(TunnelSettings{.length_mm = 600.0}, 300.0));
  EXPECT_NEAR(all.box_mm.max().x(), 600.0, 1e-9);
  EXPECT_NEAR(all.box_mm.min().x(), -100.0, 1e-9);
  EXPECT_GT(all.area_mm2, both.area_mm2);
}

// Points all over each surface: none lies outside, and each side is nearly reached.
TEST(ExactBounds, HoldEveryPointAndAreReached) {
  Rng rng(7, Stream::kTest, 3);
  const auto any_frame = [&rng] {
    const Vector3d axis(rng.normal(), rng.normal(), rng.normal());
    return frame_around(Vector3d(rng.uniform(-50, 50), 0.0, 10.0), axis.normalized());
  };
  for (int i = 0; i < 50; ++i) {
    const double radius = rng.uniform(20.0, 50.0);
    for (const EmitterShape& shape : {EmitterShape(RingShape{.frame = any_frame(),
                                     .middle_radius_mm = radius,
                                     .width_mm = radius,
                                     .tilt_rad = rng.uniform(-1.5, 1.5),
                                     .first_rad = rng.uniform(-4.0, 4.0),
                                     .span_rad = rng.uniform(0.5, 6.28)}),
                                      EmitterShape(CapShape{.frame = any_frame(),
                                      .radius_mm = radius,
                                      .top_rad = rng.uniform(0.0, 0.5),
                                      .rim_rad = rng.uniform(0.6, 3.1)})}) {
      const Eigen::AlignedBox3d box = exact_bounds_mm(shape);
      Eigen::AlignedBox3d met;
      for (int k = 0; k < 20000; ++k) {
        met.extend(point_on(shape, rng.uniform(), rng.uniform()).point_mm);
      }
      constexpr double kRounding_mm = 1e-9;
      EXPECT_TRUE((met.min().array() >= box.min().array() - kRounding_mm).all());
      EXPECT_TRUE((met.max().array() <= box.max().array() + kRounding_mm).all());
      EXPECT_LT((met.min() - box.min()).maxCoeff(), 0.1 * radius);
      EXPECT_LT((box.max() - met.max()).maxCoeff(), 0.1 * radius);
    }
  }
}

// The box of the disc's own square, turned, is wider than the disc's.
TEST(ExactBounds, OfATurnedDiscAreItsShadow) {
  const Vector3d axis = Vector3d(1.0, 1.0, 1.0).normalized();
  const RingShape disc = {
      .frame = frame_around(Vector3d::Zero(), axis), .middle_radius_mm = 5.0, .width_mm = 10.0};
  const double wide = 20.0 * std::sqrt(2.0 / 3.0);  // 2 r sqrt(1 - cos^2) with cos^2 = 1/3
  EXPECT_TRUE(exact_bounds_mm(disc).sizes().isApprox(Vector3d::Constant(wide), 1e-9));
  EXPECT_GT(bounds_mm(disc).sizes().maxCoeff(), wide + 1.0);
}

}  // namespace
}  // namespace glint

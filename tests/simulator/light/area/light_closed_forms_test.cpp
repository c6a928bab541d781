// SPDX-License-Identifier: GPL-3.0-or-later
//
// Irradiance of lights whose form factors are known.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/simulator/light/area/light_scenes.h"

namespace glint {
namespace {

using Eigen::Vector3d;

const Vector3d kUp = Vector3d::UnitZ();
constexpr int kStrata = 200;

double on_axis(const Lights& lights) {
  return irradiance(lights, Vector3d::Zero(), kUp, kStrata)[0];
}

/// Form factor of a rectangle seen from the foot of one corner in a parallel plane.
/// Source: catalogue of J. Howell, B-4.
double corner_form_factor(double a, double b, double height) {
  const double x = a / height;
  const double y = b / height;
  const double p = std::sqrt(1.0 + x * x);
  const double q = std::sqrt(1.0 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2.0 * kPi);
}

// A disc of radius 40 at height 100 is seen under tan = 0.4: sin^2 = 0.16 / 1.16.
TEST(RingLight, IlluminatesItsAxisLikeADiscMinusADisc) {
  const Lights ring = lights_of(RingSettings{.height_mm = 100.0});
  const double inner = 25.0 * 25.0 / (25.0 * 25.0 + 1e4);
  EXPECT_NEAR(on_axis(ring) / (kPi * (0.16 / 1.16 - inner)), 1.0, 1e-3);
  const Lights disc = lights_of(RingSettings{.inner_radius_mm = 0.0, .height_mm = 100.0});
  EXPECT_NEAR(on_axis(disc) / (kPi * 0.16 / 1.16), 1.0, 1e-3);
}

// Only the solid angle between the rims counts, whatever the slope between them: the middle radius
// 32.5 and half the width 7.5 put the rims at 32.5 -+ 7.5 cos(tilt), 100 -+ 7.5 sin(tilt).
TEST(RingLight, TiltedIlluminatesItsAxisLikeTheSolidAngleBetweenItsRims) {
  for (const double tilt : {0.3, 1.0, kPi / 2.0}) {
    const Lights ring = lights_of(RingSettings{.height_mm = 100.0, .tilt_rad = tilt});
    const auto squared_sine = [tilt](double side) {
      const double r = 32.5 + side * 7.5 * std::cos(tilt);
      const double h = 100.0 - side * 7.5 * std::sin(tilt);
      return r * r / (r * r + h * h);
    };
    EXPECT_NEAR(on_axis(ring) / (kPi * (squared_sine(1.0) - squared_sine(-1.0))), 1.0, 2e-3);
  }
}

TEST(DomeLight, GivesPiTimesItsRadianceInItsMiddle) {
  const Lights dome = lights_of(DomeSettings{.opening_mm = 0.0});
  EXPECT_NEAR(on_axis(dome) / kPi, 1.0, 1e-3);
  // The opening of 30 in a sphere of radius 100 is seen under sin = 0.15.
  EXPECT_NEAR(on_axis(lights_of(DomeSettings{})) / (kPi * (1.0 - 0.0225)), 1.0, 1e-3);
}

// From anywhere in the plane of the rim, a hemisphere fills the upper half of all directions.
TEST(DomeLight, GivesTheSameEverywhereInThePlaneOfItsRim) {
  const Lights dome = lights_of(DomeSettings{.opening_mm = 0.0});
  EXPECT_NEAR(irradiance(dome, {40.0, 20.0, 0.0}, kUp, 400)[0] / kPi, 1.0, 5e-3);
}

// A cap of rim angle 40 deg, its sphere's centre at the point: pi sin^2 40.
TEST(DomeLight, AsACapGivesPiTimesTheSquaredSineOfItsRim) {
  const double rim = 40.0 * kRadPerDeg;
  const Lights cap = lights_of(DomeSettings{.opening_mm = 0.0, .rim_rad = rim});
  EXPECT_NEAR(on_axis(cap) / (kPi * std::sin(rim) * std::sin(rim)), 1.0, 1e-3);
}

TEST(BarLight, IlluminatesLikeItsFormFactorNearAndFar) {
  for (const double height : {20.0, 150.0, 3000.0}) {
    const Lights bar = lights_of(BarSettings{.placement = {.position_mm = {0.0, 0.0, height}}});
    const double expected = kPi * 4.0 * corner_form_factor(100.0, 10.0, height);
    EXPECT_NEAR(on_axis(bar) / expected, 1.0, 2e-3) << height;
  }
}

// Seen across from the end of the bar: the difference of two rectangles with a common corner.
TEST(BarLight, BesideThePointIsADifferenceOfFormFactors) {
  const Lights bar = lights_of(BarSettings{.placement = {.position_mm = {150.0, 0.0, 60.0}}});
  const double expected =
      kPi * 2.0 * (corner_form_factor(250.0, 10.0, 60.0) - corner_form_factor(50.0, 10.0, 60.0));
  EXPECT_NEAR(on_axis(bar) / expected, 1.0, 2e-3);
}

TEST(MeshLight, AsTwoTrianglesIsTheRectangle) {
  const auto load = [](const std::filesystem::path&) {
    const Vector3d a(-50.0, -20.0, 0.0);
    const Vector3d b(50.0, -20.0, 0.0);
    const Vector3d c(50.0, 20.0, 0.0);
    const Vector3d d(-50.0, 20.0, 0.0);
    return std::vector<LightTriangle>{{a, b, c}, {a, c, d}, {a, a, b}};
  };
  for (const double height : {15.0, 40.0, 2000.0}) {
    const MeshLightSettings settings = {
        .placement = {.position_mm = {0.0, 0.0, height}, .direction = {0.0, 0.0, -1.0}},
        .file = "x"};
    const Lights lights = build_lights({{.name = "m", .settings = settings}}, {}, load);
    EXPECT_EQ(lights.emitters.size(), 2U);  // the third has no area
    const double expected = kPi * 4.0 * corner_form_factor(50.0, 20.0, height);
    EXPECT_NEAR(on_axis(lights) / expected, 1.0, 3e-3) << height;
  }
}

TEST(EnvironmentLight, GivesPiTimesItsRadianceUnderAnOpenSky) {
  const Lights sky = lights_of(EnvironmentSettings{.radiance = {2.0, 1.0, 0.5}});
  const auto e = irradiance(sky, Vector3d::Zero(), kUp, kStrata);
  EXPECT_NEAR(e[0], 2.0 * kPi, 0.02);
  EXPECT_NEAR(e[2], 0.5 * kPi, 0.005);
}

// Intensity I0 cos^n with n = ln 2 / -ln cos 30: from afar E = I0 / d^2, and power = 2 pi I0 / (n +
// 1).
TEST(LedLight, FollowsItsLobeFromAfar) {
  const double n = std::log(2.0) / -std::log(std::cos(kPi / 6.0));
  const RingSettings led = {.emission = {.power_w = {0.7}, .half_angle_rad = kPi / 6.0},
                            .inner_radius_mm = 0.0,
                            .outer_radius_mm = 1.0};
  const Lights lights = lights_of(led);
  const double intensity = 0.7 * (n + 1.0) / (2.0 * kPi);
  for (const double angle : {0.0, kPi / 6.0, 1.2}) {
    const Vector3d out(std::sin(angle), 0.0, -std::cos(angle));
    const double e = irradiance(lights, 1000.0 * out, -out, 100)[0];  // at 1 m
    EXPECT_NEAR(e / (intensity * std::pow(std::cos(angle), n)), 1.0, 2e-3) << angle;
  }
}

// 0.7 W spread over two segments of which one is twice and one not at all on.
TEST(LightGroups, CarryTheFactorsOfSegmentsAndThePowersOfTheirLights) {
  RingSettings ring = {.emission = {.power_w = {0.7}},
                       .segments = {.segments = 2, .segment_power = {2.0, 0.0}},
                       .height_mm = 100.0};
  const Lights one = lights_of(ring);
  ASSERT_EQ(one.groups.size(), 1U);
  EXPECT_NEAR(one.groups[0].power_w[0], 0.7F, 1e-6F);  // 2 * 0.35 + 0
  ring.segments.separate = true;
  const Lights two = lights_of(ring);
  ASSERT_EQ(two.groups.size(), 2U);
  EXPECT_EQ(two.groups[1].name, "light.1");
  EXPECT_EQ(two.groups[1].factor, 0.0);
  EXPECT_NEAR(two.groups[1].power_w[0], 0.35F, 1e-6F);
}

// 1e6 times the power gives exactly 1e6 times the light: nothing is clamped.
TEST(LightPower, EntersLinearly) {
  BarSettings bar;
  const double weak = on_axis(lights_of(bar));
  bar.emission.radiance = {1048576.0};
  EXPECT_EQ(on_axis(lights_of(bar)), 1048576.0 * weak);
}

TEST(CoaxialLight, IsSeenThroughFromBehindAndDimmedByTheSplitter) {
  const RigidTransform scene_from_camera = {.rotation = Eigen::DiagonalMatrix<double, 3>(1, -1, -1),
                                            .translation_mm = {0.0, 0.0, 200.0}};
  CoaxialSettings settings;
  settings.placement.position_mm = {0.0, 0.0, 50.0};  // in front of the camera
  const Lights lights = lights_of(settings, scene_from_camera);
  EXPECT_FALSE(hit_light(lights, {.origin_mm = {0.0, 0.0, 200.0}, .direction = -kUp}).has_value());
  const auto hit = hit_light(lights, {.origin_mm = {1.0, 2.0, 0.0}, .direction = kUp});
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->distance_mm, 150.0, 1e-9);
  EXPECT_EQ(hit->radiance[0], 0.5F);
}

TEST(SolidLight, HidesWithItsBackWhatIsBehindIt) {
  const std::vector<NamedLight> named = {
      {.name = "up", .settings = BarSettings{.placement = {.position_mm = {0.0, 0.0, 300.0}}}},
      {.name = "down",
       .settings = BarSettings{
           .placement = {.position_mm = {0.0, 0.0, 100.0}, .direction = {0.0, 0.0, 1.0}}}}};
  const Lights lights = build_lights(named, {}, {});
  const auto hit = hit_light(lights, {.direction = kUp});
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->distance_mm, 100.0, 1e-9);
  EXPECT_EQ(hit->radiance[0], 0.0F);
  const auto sample = sample_light(lights, Vector3d::Zero(), 0.5, 0.5);
  ASSERT_TRUE(sample.has_value());
  EXPECT_EQ(sample->group, 0);
  EXPECT_TRUE(is_occluded(lights, Vector3d::Zero(), *sample));
}

}  // namespace
}  // namespace glint

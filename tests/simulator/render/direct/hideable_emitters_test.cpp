// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "simulator/render/direct/hideable_emitters.h"
#include "tests/simulator/render/direct/direct_bench.h"

namespace glint::direct_test {
namespace {

const Eigen::AlignedBox3d kPartBox(Vector3d(-20.0, -15.0, -3.0), Vector3d(20.0, 15.0, 5.0));

bool has_any(const Lights& lights) {
  return std::ranges::any_of(hideable_emitters(lights, kPartBox),
                             [](std::uint8_t is) { return is != 0; });
}

Lights ready(Lights lights) {
  lights.tree = LightTree(lights.emitters, lights.bodies);
  return lights;
}

TEST(HideableEmitters, AreNoneOfARingOfLeds) {
  RingSettings ring;
  ring.placement.position_mm = {0.0, 0.0, 100.0};
  ring.leds = 24;
  for (const double tilt : {0.0, 0.5}) {
    ring.tilt_rad = tilt;
    EXPECT_FALSE(has_any(path_test::lights_of({{.name = "ring", .settings = ring}}, {}))) << tilt;
  }
}

/// A ring of four sectors around the axis of the part.
Lights sectors(double tilt_rad, double height_mm) {
  RingSettings ring;
  ring.placement.position_mm = {0.0, 0.0, height_mm};
  ring.inner_radius_mm = 40.0;
  ring.outer_radius_mm = 60.0;
  ring.tilt_rad = tilt_rad;
  ring.segments.segments = 4;
  return path_test::lights_of({{.name = "ring", .settings = ring}}, {});
}

TEST(HideableEmitters, AreNoneOfTheSectorsOfAConeAroundThePart) {
  for (const double tilt : {0.0, 0.3, 0.5236, 1.0}) {
    EXPECT_FALSE(has_any(sectors(tilt, 60.0))) << tilt;
  }
}

// The apex of the cone lies 50 mm x tan(30 deg) = 29 mm above the ring: above a ring at -32 mm a
// part that ends at -3 mm and 5 mm is not inside.
TEST(HideableEmitters, AreSectorsOfAConeThatThePartRisesAbove) {
  EXPECT_TRUE(has_any(sectors(0.5236, -32.0)));
}

TEST(HideableEmitters, AreThoseBehindAnother) {
  const EmitterFrame far = frame_around({0.0, 0.0, 200.0}, -Vector3d::UnitZ());
  const EmitterFrame near = frame_around({0.0, 0.0, 100.0}, -Vector3d::UnitZ());
  const Lights lights =
      lights_with({RectangleShape{.frame = far, .half_x_mm = 50, .half_y_mm = 50},
                   RectangleShape{.frame = near, .half_x_mm = 9, .half_y_mm = 9}});
  const auto hideable = hideable_emitters(lights, kPartBox);
  EXPECT_EQ(hideable, (std::vector<std::uint8_t>{1, 0}));
}

TEST(HideableEmitters, AreADomeBehindARingButNotTheRing) {
  const Lights lights =
      lights_with({CapShape{.radius_mm = 150.0}, ring_above(20.0, 40.0, {0.0, 0.0, 90.0})});
  EXPECT_EQ(hideable_emitters(lights, kPartBox), (std::vector<std::uint8_t>{1, 0}));
}

Vector3d random_place(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(20.0, 200.0)};
}

Vector3d random_down(Rng& rng) {
  return Vector3d{rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), -1.0}.normalized();
}

/// Whether some ray from the box to the emitter meets another one first.
bool is_seen_hidden(const Lights& lights, std::size_t emitter, Rng& rng) {
  for (int k = 0; k < 300; ++k) {
    // In braces, so that every compiler draws in this order.
    const Vector3d share{rng.uniform(), rng.uniform(), rng.uniform()};
    const std::array<double, 2> uv{rng.uniform(), rng.uniform()};
    const Vector3d from = kPartBox.min() + kPartBox.sizes().cwiseProduct(share);
    const ShapePoint to = point_on(lights.emitters[emitter].shape, uv[0], uv[1]);
    const Vector3d way = to.point_mm - from;
    const LightSample sample = {.direction = way.normalized(),
                                .distance_mm = way.norm() * (1.0 - 1e-6)};
    if (to.normal.dot(way) < 0.0 && is_occluded(lights, from, sample)) {
      return true;
    }
  }
  return false;
}

/// No emitter that is hidden from a point is taken for one that is not.
TEST(HideableEmitters, LackNoneThatRaysFind) {
  Rng rng(44, Stream::kTest, 0);
  int hidden = 0;
  int safe = 0;
  for (int k = 0; k < 200; ++k) {
    const EmitterShape a = ring_above(10.0, rng.uniform(15.0, 50.0), random_place(rng, 50.0));
    const EmitterShape b =
        RectangleShape{.frame = frame_around(random_place(rng, 80.0), random_down(rng)),
                       .half_x_mm = rng.uniform(5.0, 80.0),
                       .half_y_mm = rng.uniform(5.0, 30.0)};
    const Lights lights = ready(lights_with({a, b}));
    const auto hideable = hideable_emitters(lights, kPartBox);
    for (std::size_t i = 0; i < 2; ++i) {
      const bool is_hidden = is_seen_hidden(lights, i, rng);
      hidden += is_hidden ? 1 : 0;
      safe += hideable[i] == 0 ? 1 : 0;
      EXPECT_FALSE(is_hidden && hideable[i] == 0) << k << " " << i;
    }
  }
  EXPECT_GT(hidden, 10);
  EXPECT_GT(safe, 50);
}

TEST(HideableEmitters, LackNoSectorThatRaysFind) {
  Rng rng(45, Stream::kTest, 0);
  int hidden = 0;
  int safe = 0;
  for (int k = 0; k < 100; ++k) {
    const double tilt_rad = rng.uniform(-1.4, 1.4);
    const Lights lights = ready(sectors(tilt_rad, rng.uniform(-60.0, 30.0)));
    const auto hideable = hideable_emitters(lights, kPartBox);
    for (std::size_t i = 0; i < lights.emitters.size(); ++i) {
      const bool is_hidden = is_seen_hidden(lights, i, rng);
      hidden += is_hidden ? 1 : 0;
      safe += hideable[i] == 0 ? 1 : 0;
      EXPECT_FALSE(is_hidden && hideable[i] == 0) << k << " " << i;
    }
  }
  EXPECT_GT(hidden, 10);
  EXPECT_GT(safe, 50);
}

}  // namespace
}  // namespace glint::direct_test

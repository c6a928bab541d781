// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel/tunnel_kernels.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "simulator/light/tunnel/spline_kernels.h"
#include "simulator/light/tunnel/tunnel.h"
#include "tests/simulator/light/tunnel/shaped_tunnel.h"

namespace glint {
namespace {

using Shape = TunnelSettings::Shape;

/// Rays from inside a part-sized box, upwards, as arrays.
struct RandomRays {
  std::array<std::vector<float>, 6> arrays;

  explicit RandomRays(int count) {
    for (int i = 0; i < count; ++i) {
      Rng rng(11, Stream::kTest, static_cast<std::uint64_t>(i));
      const double azimuth = rng.uniform(0.0, 2.0 * kPi);
      const double z = rng.uniform(0.01, 1.0);
      const double r = std::sqrt(1.0 - z * z);
      const std::array<double, 6> ray = {rng.uniform(-100, 100),
                                         rng.uniform(-25, 25),
                                         rng.uniform(0.0, 8.0),
                                         r * std::cos(azimuth),
                                         r * std::sin(azimuth),
                                         z};
      for (std::size_t k = 0; k < 6; ++k) {
        arrays[k].push_back(static_cast<float>(ray[k]));
      }
    }
  }

  RayBlock block() const {
    return {.origin_x = arrays[0].data(),
            .origin_y = arrays[1].data(),
            .origin_z = arrays[2].data(),
            .direction_x = arrays[3].data(),
            .direction_y = arrays[4].data(),
            .direction_z = arrays[5].data(),
            .count = static_cast<int>(arrays[0].size())};
  }

  Ray ray(std::size_t i) const {
    return {.origin_mm = vector_of(arrays[0][i], arrays[1][i], arrays[2][i]),
            .direction = vector_of(arrays[3][i], arrays[4][i], arrays[5][i])};
  }
};

class TunnelKernels : public ::testing::TestWithParam<Shape> {};

TEST_P(TunnelKernels, AgreeWithTheExactHitInDouble) {
  TunnelSettings settings = test::shaped_tunnel(GetParam(), 20.0);
  settings.length_mm = 1000.0;
  const Tunnel tunnel(settings);
  const int count = 5003;  // no multiple of any vector width
  const RandomRays rays(count);
  std::vector<float> x(count);
  std::vector<float> q(count);
  std::vector<float> gain(count);
  tunnel.hit_block(rays.block(), x.data(), q.data(), gain.data());
  int disagreements = 0;
  int hits = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const auto exact = tunnel.hit(rays.ray(i));
    if (exact.has_value() != (gain[i] > 0.0F)) {
      ++disagreements;  // rounding to float right at a rim or at the slot's edge
      continue;
    }
    if (exact) {
      ++hits;
      // Float carries 1e-7 of the longest path, grazing rays lose one more digit.
      EXPECT_NEAR(static_cast<double>(x[i]), exact->point_mm.x(), 2e-4 + 2e-6 * exact->t_mm) << i;
    }
  }
  EXPECT_GT(hits, count / 3);
  EXPECT_LE(disagreements, 2);
}

// Short cuts that skip what a chunk of rays surely misses must not show in any of them.
TEST_P(TunnelKernels, ARayIsHitTheSameWhateverStandsBesideIt) {
  const Tunnel tunnel(test::shaped_tunnel(GetParam(), 20.0));
  const int count = 2003;
  const RandomRays rays(count);
  const auto size = static_cast<std::size_t>(count);
  std::array<std::vector<float>, 3> all;
  all.fill(std::vector<float>(size));
  tunnel.intersect_block(rays.block(), all[0].data(), all[1].data(), all[2].data());
  const RayBlock block = rays.block();
  for (std::size_t i = 0; i < size; ++i) {
    const RayBlock alone = {.origin_x = block.origin_x + i,
                            .origin_y = block.origin_y + i,
                            .origin_z = block.origin_z + i,
                            .direction_x = block.direction_x + i,
                            .direction_y = block.direction_y + i,
                            .direction_z = block.direction_z + i,
                            .count = 1};
    std::array<float, 3> one = {};
    tunnel.intersect_block(alone, &one[0], &one[1], &one[2]);
    EXPECT_EQ(one, (std::array<float, 3>{all[0][i], all[1][i], all[2][i]})) << i;
  }
}

// From a rhombus to nearly a rectangle: the same number of steps of Newton's method is enough.
TEST(HitSuperellipse, AgreesWithTheExactHitForEveryExponent) {
  const int count = 2000;
  const RandomRays rays(count);
  std::vector<float> x(count);
  std::vector<float> q(count);
  std::vector<float> gain(count);
  for (const double exponent : {1.0, 1.5, 2.0, 6.0, 20.0}) {
    const Tunnel tunnel({.shape = Shape::kSuperellipse,
                         .half_width_mm = 90.0,
                         .height_mm = 120.0,
                         .exponent = exponent,
                         .slot_mm = 0.0});
    tunnel.hit_block(rays.block(), x.data(), q.data(), gain.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const auto exact = tunnel.hit(rays.ray(i));
      if (exact && gain[i] > 0.0F) {
        EXPECT_NEAR(static_cast<double>(x[i]), exact->point_mm.x(), 1e-3 + 1e-5 * exact->t_mm)
            << "exponent " << exponent << ", ray " << i;
      }
    }
  }
}

// Oblique stripes and the cosine law take normal and arc length from the profile.
TEST_P(TunnelKernels, PatternCoordinateAndCosineFollowTheExactHit) {
  TunnelSettings settings = test::shaped_tunnel(GetParam(), 20.0);
  settings.length_mm = 1000.0;
  settings.orientation_rad = 0.6;
  settings.cosine_law = true;
  const Tunnel tunnel(settings);
  const int count = 1000;
  const RandomRays rays(count);
  std::vector<float> x(count);
  std::vector<float> q(count);
  std::vector<float> gain(count);
  tunnel.hit_block(rays.block(), x.data(), q.data(), gain.data());
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const auto exact = tunnel.hit(rays.ray(i));
    if (!exact || gain[i] == 0.0F) {
      continue;
    }
    const double along = exact->point_mm.x() * std::cos(0.6) + exact->arc_mm * std::sin(0.6);
    EXPECT_NEAR(static_cast<double>(q[i]), along, 1e-3 + 2e-6 * exact->t_mm) << i;
    EXPECT_NEAR(
        static_cast<double>(gain[i]), std::abs(exact->normal.dot(rays.ray(i).direction)), 2e-3)
        << i;
  }
}

INSTANTIATE_TEST_SUITE_P(AllShapes,
                         TunnelKernels,
                         ::testing::Values(Shape::kFlat,
                                           Shape::kSemicylinder,
                                           Shape::kEllipse,
                                           Shape::kSuperellipse,
                                           Shape::kFree));

// Period 10, duty 0.3: x = 0, 2.9 are bright, 3.1 and 9.9 dark (0.1), 10 bright again; beyond the
// half length of 50 nothing shines. Gain 2 and scale 0.5 cancel.
TEST(AddStripes, FollowsTheSquareWaveByHand) {
  const std::vector<float> x = {0.0F, 2.9F, 3.1F, 9.9F, 10.0F, -7.1F, -6.9F, 50.5F};
  const std::vector<float> gain(x.size(), 2.0F);
  std::vector<float> out(x.size(), 0.0F);
  const StripePattern pattern = {
      .periods_per_mm = 0.1F, .duty = 0.3F, .dark = 0.1F, .half_length_mm = 50.0F};
  add_stripes(
      x.data(), x.data(), gain.data(), static_cast<int>(x.size()), pattern, 0.5F, out.data());
  const std::vector<float> expected = {1.0F, 1.0F, 0.1F, 0.1F, 1.0F, 1.0F, 0.1F, 0.0F};
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_FLOAT_EQ(out[i], expected[i]) << i;
  }
}

// The tunnel moved by +4: the stripe that began at 0 begins at 4, and the far end moves along.
TEST(AddStripes, TheWholeTunnelMovesWithTheShift) {
  const std::vector<float> x = {3.9F, 4.1F, 53.9F, -46.5F};
  const std::vector<float> gain(x.size(), 1.0F);
  std::vector<float> out(x.size(), 0.0F);
  const StripePattern pattern = {.shift_x_mm = 4.0F,
                                 .shift_pattern_mm = 4.0F,
                                 .periods_per_mm = 0.1F,
                                 .duty = 1.0F,
                                 .half_length_mm = 50.0F};
  add_stripes(x.data(), x.data(), gain.data(), 4, pattern, 1.0F, out.data());
  EXPECT_FLOAT_EQ(out[2], 1.0F);
  EXPECT_FLOAT_EQ(out[3], 0.0F);  // -46.5 - 4 = -50.5
}

// Ripple 0.5: 1 at a LED, (1 - 0.5) / 1.5 = 1/3 between two. Falloff 0.2 at half way: 1 - 0.05.
TEST(AddStripes, LedRippleAndFalloffByHand) {
  const std::vector<float> x = {0.0F, 10.0F, 20.0F};
  const std::vector<float> gain(x.size(), 1.0F);
  std::vector<float> out(x.size(), 0.0F);
  StripePattern pattern = {.periods_per_mm = 0.001F,
                           .duty = 1.0F,
                           .half_length_mm = 40.0F,
                           .led_ripple = 0.5F,
                           .led_per_mm = 0.05F};
  add_stripes(x.data(), x.data(), gain.data(), 3, pattern, 1.0F, out.data());
  EXPECT_NEAR(out[0], 1.0F, 1e-5F);
  EXPECT_NEAR(out[1], 1.0F / 3.0F, 1e-5F);
  pattern.led_ripple = 0.0F;
  pattern.end_falloff = 0.2F;
  out.assign(3, 0.0F);
  add_stripes(x.data(), x.data(), gain.data(), 3, pattern, 1.0F, out.data());
  EXPECT_NEAR(out[2], 0.95F, 1e-6F);
}

/// A half circle of segments whose middles bulge, in Hermite's form, ends at the knots.
std::vector<SplineSegment> half_circle(int segments, double radius_mm, double bulge) {
  std::vector<SplineSegment> result;
  for (int s = 0; s < segments; ++s) {
    const double from = kPi * s / segments;
    const double to = kPi * (s + 1) / segments;
    const auto cubic = [&](double p0, double p1, double slope0, double slope1) {
      return std::array{
          p0, slope0, 3.0 * (p1 - p0) - 2.0 * slope0 - slope1, 2.0 * (p0 - p1) + slope0 + slope1};
    };
    const double size = bulge * radius_mm * (to - from);
    const auto y = cubic(radius_mm * std::cos(from),
                         radius_mm * std::cos(to),
                         -size * std::sin(from),
                         -size * std::sin(to));
    const auto z = cubic(radius_mm * std::sin(from),
                         radius_mm * std::sin(to),
                         size * std::cos(from),
                         size * std::cos(to));
    result.push_back({.y = {y[0], y[1], y[2], y[3]}, .z = {z[0], z[1], z[2], z[3]}});
  }
  return result;
}

// Rays from all over to each knot and a few floats beside it.
TEST(HitSpline, LetsNoRayThroughBetweenSegments) {
  for (const double bulge : {1.0, 1.1}) {
    const std::vector<SplineSegment> segments = half_circle(9, 137.0, bulge);
    RandomRays rays(0);
    Rng rng(17, Stream::kTest, 0);
    for (int i = 0; i < 3200; ++i) {
      const SplineSegment& segment = segments[static_cast<std::size_t>(1 + i % 8)];
      const auto from_y = static_cast<float>(rng.uniform(-30.0, 30.0));
      const auto from_z = static_cast<float>(rng.uniform(0.0, 10.0));
      auto to_y = static_cast<float>(segment.y[0]) - from_y;
      for (int step = i % 7; step > 0; --step) {
        to_y = std::nextafter(to_y, i % 2 == 0 ? 1e9F : -1e9F);
      }
      const std::array<float, 6> ray = {
          0.0F, from_y, from_z, 0.0F, to_y, static_cast<float>(segment.z[0]) - from_z};
      for (std::size_t k = 0; k < ray.size(); ++k) {
        rays.arrays[k].push_back(ray[k]);
      }
    }
    std::vector<float> t_mm(rays.arrays[0].size());
    hit_spline(rays.block(), segments.data(), 9, t_mm.data());
    for (std::size_t i = 0; i < t_mm.size(); ++i) {
      ASSERT_NEAR(t_mm[i], 1.0F, 1e-4F) << i;  // in units of the directions, which reach the knots
    }
  }
}

// Rays to known places of a piece that runs slowly at first and sixty times as fast at last, so
// that the chord is a poor start.
TEST(HitSpline, MeetsAPieceOfUnevenSpeedWhereItIs) {
  const SplineSegment segment = {.y = {-50.0, 5.0, 0.0, 95.0}, .z = {100.0, 40.0, 0.0, 0.0}};
  RandomRays rays(0);
  for (int i = 1; i < 1000; ++i) {
    const double u = i / 1000.0;
    const std::array<float, 6> ray = {0.0F,
                                      0.0F,
                                      0.0F,
                                      0.0F,
                                      static_cast<float>(-50.0 + 5.0 * u + 95.0 * u * u * u),
                                      static_cast<float>(100.0 + 40.0 * u)};
    for (std::size_t k = 0; k < ray.size(); ++k) {
      rays.arrays[k].push_back(ray[k]);
    }
  }
  std::vector<float> t_mm(rays.arrays[0].size());
  hit_spline(rays.block(), &segment, 1, t_mm.data());
  for (std::size_t i = 0; i < t_mm.size(); ++i) {
    ASSERT_NEAR(t_mm[i], 1.0F, 2e-6F) << i;  // in units of the directions, which reach the places
  }
}

}  // namespace
}  // namespace glint

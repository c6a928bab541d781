// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel/shape_derivative.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "tests/simulator/light/tunnel/shaped_tunnel.h"

namespace glint {
namespace {

using Shape = TunnelSettings::Shape;

/// One ray in float, its hit in double.
struct MovedHit {
  std::array<float, 6> ray = {};
  std::array<float, 3> hit = {};  ///< x, y, margin

  RayBlock block() const {
    return {.origin_x = &ray[0],
            .origin_y = &ray[1],
            .origin_z = &ray[2],
            .direction_x = &ray[3],
            .direction_y = &ray[4],
            .direction_z = &ray[5],
            .count = 1};
  }

  HitBlock hits() const { return {.x_mm = &hit[0], .y_mm = &hit[1], .margin_mm = &hit[2]}; }

  Ray exact() const {
    return {.origin_mm = vector_of(ray[0], ray[1], ray[2]),
            .direction = vector_of(ray[3], ray[4], ray[5])};
  }
};

/// What of a hit is differentiated: weights of x and y.
constexpr std::array<float, 2> kByX = {1.0F, 0.0F};
constexpr std::array<float, 2> kByY = {0.0F, 1.0F};

HitGradient gradient_of(const std::array<float, 2>& by, const float& none) {
  return {.x = &by[0], .y = &by[1], .margin = &none};
}

class ShapeDerivativeOf : public ::testing::TestWithParam<Shape> {
 protected:
  static TunnelSettings settings() {
    TunnelSettings settings = test::raised_tunnel(GetParam(), 0.0);
    settings.blocks_view = false;
    return settings;
  }

  static std::vector<std::string> keys() {
    switch (GetParam()) {
      case Shape::kFlat:
        return {"base_mm", "distance_mm", "opening_deg", "panel_height_mm"};
      case Shape::kSemicylinder:
        return {"base_mm", "radius_mm"};
      case Shape::kEllipse:
        return {"base_mm", "half_width_mm", "height_mm"};
      case Shape::kSuperellipse:
        return {"base_mm", "half_width_mm", "height_mm", "exponent"};
      case Shape::kFree:
        break;
    }
    return {
        "base_mm", "control_mm.0", "control_mm.1", "control_mm.2", "control_mm.3", "control_mm.4"};
  }

  static double& number(TunnelSettings& t, const std::string& key) {
    if (key.starts_with("control_mm.")) {
      return t.control_mm[static_cast<std::size_t>(key.back() - '0')];
    }
    return key == "base_mm"         ? t.base_mm
           : key == "radius_mm"     ? t.radius_mm
           : key == "half_width_mm" ? t.half_width_mm
           : key == "height_mm"     ? t.height_mm
           : key == "exponent"      ? t.exponent
           : key == "distance_mm"   ? t.distance_mm
           : key == "opening_deg"   ? t.opening_rad
                                    : t.panel_height_mm;
  }

  /// Rays upwards from where a part lies that hit the wall away from its ends.
  static std::vector<MovedHit> random_hits(int count) {
    const Tunnel tunnel(settings());
    std::vector<MovedHit> found;
    for (std::uint64_t i = 0; static_cast<int>(found.size()) < count; ++i) {
      Rng rng(71, Stream::kTest, i);
      const double azimuth = rng.uniform(0.0, 2.0 * kPi);
      const double z = rng.uniform(0.2, 1.0);
      const double r = std::sqrt(1.0 - z * z);
      const std::array<double, 6> numbers = {rng.uniform(-20.0, 20.0),
                                             rng.uniform(-20.0, 20.0),
                                             rng.uniform(4.0, 12.0),
                                             r * std::cos(azimuth),
                                             r * std::sin(azimuth),
                                             z};
      MovedHit hit;
      for (std::size_t k = 0; k < 6; ++k) {
        hit.ray[k] = static_cast<float>(numbers[k]);
      }
      tunnel.intersect_block(hit.block(), &hit.hit[0], &hit.hit[1], &hit.hit[2]);
      if (hit.hit[2] > 2.0F && tunnel.hit(hit.exact())) {
        found.push_back(hit);
      }
    }
    return found;
  }
};

/// The derivative by a central difference of exact hits.
double difference(const std::function<std::optional<WallHit>(double)>& hit_at,
                  double step,
                  const std::array<float, 2>& by) {
  const auto value = [&](double change) {
    const Eigen::Vector3d p = hit_at(change).value().point_mm;
    return static_cast<double>(by[0]) * p.x() + static_cast<double>(by[1]) * p.y();
  };
  return (value(step) - value(-step)) / (2.0 * step);
}

// Ends of the wall are kept 2 mm away, so that a key that moves them has no part in x and y. The
// wall's motion is taken as linear between 2,049 nodes: less than 1e-3 of it.
TEST_P(ShapeDerivativeOf, KeysMoveHitsAsDifferencesOfExactHitsTell) {
  constexpr double kStep = 1e-3;
  const float none = 0.0F;
  const ShapeDerivative empty{Tunnel(settings())};
  const std::vector<MovedHit> rays = random_hits(1000);
  double largest = 0.0;
  for (const std::string& key : keys()) {
    TunnelSettings high = settings();
    TunnelSettings low = settings();
    number(high, key) += kStep;
    number(low, key) -= kStep;
    const Tunnel above(high);
    const Tunnel below(low);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Rng rng(79, Stream::kTest, i);
      const std::array<float, 2> by = {static_cast<float>(rng.uniform(-1.0, 1.0)),
                                       static_cast<float>(rng.uniform(-1.0, 1.0))};
      ShapeDerivative motion = empty;
      motion.collect(rays[i].block(), rays[i].hits(), gradient_of(by, none));
      const double expected = difference(
          [&](double change) { return (change > 0.0 ? above : below).hit(rays[i].exact()); },
          kStep,
          by);
      const double found = motion.derivative_by(key).value();
      EXPECT_NEAR(found, expected, 2e-3 + 1e-3 * std::abs(expected)) << key;
      largest = std::max(largest, std::abs(expected));
    }
  }
  EXPECT_GT(largest, 0.5);
}

// The sum over many rays is what a search uses: single errors cancel.
TEST_P(ShapeDerivativeOf, DerivativesOfManyRaysAddUp) {
  const Tunnel tunnel(settings());
  const float none = 0.0F;
  ShapeDerivative all(tunnel);
  double sum = 0.0;
  for (const MovedHit& ray : random_hits(50)) {
    ShapeDerivative one(tunnel);
    one.collect(ray.block(), ray.hits(), gradient_of(kByX, none));
    all.collect(ray.block(), ray.hits(), gradient_of(kByX, none));
    sum += one.derivative_by("base_mm").value();
  }
  EXPECT_NEAR(all.derivative_by("base_mm").value(), sum, 1e-9 * (1.0 + std::abs(sum)));
}

TEST_P(ShapeDerivativeOf, RaysMoveHitsAsDifferencesOfExactHitsTell) {
  const Tunnel tunnel(settings());
  const ShapeDerivative motion(tunnel);
  const float none = 0.0F;
  std::uint64_t index = 0;
  for (const MovedHit& ray : random_hits(1000)) {
    Rng rng(73, Stream::kTest, index++);
    std::array<float, 6> by_one = {};
    for (std::size_t k = 0; k < 6; ++k) {
      by_one[k] = static_cast<float>(rng.uniform(-1.0, 1.0) * (k < 3 ? 1.0 : 0.01));
    }
    const RayMotion moving = {.origin_x = &by_one[0],
                              .origin_y = &by_one[1],
                              .origin_z = &by_one[2],
                              .direction_x = &by_one[3],
                              .direction_y = &by_one[4],
                              .direction_z = &by_one[5]};
    for (const auto& by : {kByX, kByY}) {
      const double expected = difference(
          [&](double change) {
            Ray moved = ray.exact();
            moved.origin_mm += change * vector_of(by_one[0], by_one[1], by_one[2]);
            moved.direction += change * vector_of(by_one[3], by_one[4], by_one[5]);
            return tunnel.hit(moved);
          },
          1e-3,
          by);
      const double found =
          motion.derivative_by_rays(ray.block(), moving, ray.hits(), gradient_of(by, none));
      EXPECT_NEAR(found, expected, 5e-3 + 2e-3 * std::abs(expected));
    }
  }
}

// Negative control: a wall that moved inwards instead of outwards would be noticed.
TEST_P(ShapeDerivativeOf, TheOtherSignWouldBeNoticed) {
  const Tunnel tunnel(settings());
  const float none = 0.0F;
  int noticed = 0;
  for (const MovedHit& ray : random_hits(100)) {
    ShapeDerivative motion(tunnel);
    motion.collect(ray.block(), ray.hits(), gradient_of(kByX, none));
    const double found = motion.derivative_by("base_mm").value();
    noticed += std::abs(2.0 * found) > 2e-3 + 1e-3 * std::abs(found) ? 1 : 0;
  }
  EXPECT_GT(noticed, 80);
}

INSTANTIATE_TEST_SUITE_P(AllShapes,
                         ShapeDerivativeOf,
                         ::testing::Values(Shape::kFlat,
                                           Shape::kSemicylinder,
                                           Shape::kEllipse,
                                           Shape::kSuperellipse,
                                           Shape::kFree));

// A ray from (0, 0, 0) along (3, 0, 4) / 5 meets the top of a circle of radius 100 at t = 125,
// x = 75. The wall's normal is z: dt = 1 / (4 / 5) = 1.25 a millimetre of radius or base, and
// dx = 1.25 * 3 / 5 = 0.75. At the top y does not change, nor does the other shapes' half width
// act.
TEST(ShapeDerivative, MatchesAHandWorkedRay) {
  const Tunnel tunnel({.shape = Shape::kSemicylinder, .radius_mm = 100.0, .slot_mm = 0.0});
  MovedHit ray;
  ray.ray = {0.0F, 0.0F, 0.0F, 0.6F, 0.0F, 0.8F};
  ray.hit = {75.0F, 0.0F, 100.0F};
  const float none = 0.0F;
  ShapeDerivative motion(tunnel);
  motion.collect(ray.block(), ray.hits(), gradient_of(kByX, none));
  EXPECT_NEAR(motion.derivative_by("radius_mm").value(), 0.75, 1e-6);
  EXPECT_NEAR(motion.derivative_by("base_mm").value(), 0.75, 1e-6);
  EXPECT_DOUBLE_EQ(motion.derivative_by("half_width_mm").value(), 0.0);
  EXPECT_FALSE(motion.derivative_by("period_mm"));
}

// The same ray moved by 2 mm along z: it meets the top 2 / (4 / 5) = 2.5 mm earlier, 1.5 mm less in
// x; moved by 1 mm along x it meets it 1 mm further.
TEST(ShapeDerivative, MatchesAHandWorkedMotionOfARay) {
  const Tunnel tunnel({.shape = Shape::kSemicylinder, .radius_mm = 100.0, .slot_mm = 0.0});
  MovedHit ray;
  ray.ray = {0.0F, 0.0F, 0.0F, 0.6F, 0.0F, 0.8F};
  ray.hit = {75.0F, 0.0F, 100.0F};
  const float none = 0.0F;
  const float one = 1.0F;
  const float two = 2.0F;
  const ShapeDerivative motion(tunnel);
  const auto derivative = [&](const float& x, const float& z) {
    return motion.derivative_by_rays(ray.block(),
                                     {.origin_x = &x,
                                      .origin_y = &none,
                                      .origin_z = &z,
                                      .direction_x = &none,
                                      .direction_y = &none,
                                      .direction_z = &none},
                                     ray.hits(),
                                     gradient_of(kByX, none));
  };
  EXPECT_NEAR(derivative(none, two), -1.5, 1e-6);
  EXPECT_NEAR(derivative(one, none), 1.0, 1e-6);
}

// z = b (1 - q)^(1/e) with q = (y / a)^e above a ray that rises from (0, y, 0): dz = b q / a
// (1 - q)^(1/e - 1) a millimetre of a, and dx = 3/4 of it along (3, 0, 4) / 5. Near the top that
// goes as y^1.5, which straight lines between evenly spaced nodes miss by a few per cent.
TEST(ShapeDerivative, FollowsASuperellipseUpToItsTop) {
  const Tunnel tunnel({.shape = Shape::kSuperellipse,
                       .half_width_mm = 90.0,
                       .height_mm = 120.0,
                       .exponent = 1.5,
                       .slot_mm = 0.0});
  const float none = 0.0F;
  for (const double y_mm : {0.3, 0.5, -1.0, 3.0}) {
    MovedHit ray;
    ray.ray = {0.0F, static_cast<float>(y_mm), 0.0F, 0.6F, 0.0F, 0.8F};
    tunnel.intersect_block(ray.block(), &ray.hit[0], &ray.hit[1], &ray.hit[2]);
    ShapeDerivative motion(tunnel);
    motion.collect(ray.block(), ray.hits(), gradient_of(kByX, none));
    const double q = std::pow(std::abs(y_mm) / 90.0, 1.5);
    const double expected = 0.75 * 120.0 * q / 90.0 * std::pow(1.0 - q, 1.0 / 1.5 - 1.0);
    EXPECT_NEAR(motion.derivative_by("half_width_mm").value(), expected, 2e-3 * expected) << y_mm;
  }
}

// Panels at 45 degrees meet at z = 60: a ray along (3, 0, 4) / 5 reaches the ridge at t = 75. Moved
// by 1 mm along y it meets a panel 1.25 mm earlier, on one side as on the other, and x is 0.75 mm
// less; moved back as well. So x does not change on average over both ways.
TEST(ShapeDerivative, ARayOnARidgeMovesByTheMeanOfBothPanels) {
  const Tunnel roof({.shape = Shape::kFlat,
                     .distance_mm = 60.0,
                     .opening_rad = 0.5 * kPi,
                     .panel_height_mm = 100.0,
                     .slot_mm = 0.0});
  const ShapeDerivative motion(roof);
  const float none = 0.0F;
  const float one = 1.0F;
  const auto derivative_at = [&](float y_mm) {
    MovedHit ray;
    ray.ray = {0.0F, y_mm, 0.0F, 0.6F, 0.0F, 0.8F};
    roof.intersect_block(ray.block(), &ray.hit[0], &ray.hit[1], &ray.hit[2]);
    return motion.derivative_by_rays(ray.block(),
                                     {.origin_x = &none,
                                      .origin_y = &one,
                                      .origin_z = &none,
                                      .direction_x = &none,
                                      .direction_y = &none,
                                      .direction_z = &none},
                                     ray.hits(),
                                     gradient_of(kByX, none));
  };
  EXPECT_NEAR(derivative_at(0.01F), -0.75, 1e-6);
  EXPECT_NEAR(derivative_at(-0.01F), 0.75, 1e-6);
  EXPECT_NEAR(derivative_at(0.0F), 0.0, 1e-12);
}

/// Rays that meet a wall of 256 pieces anywhere between two angles from its foot.
struct StrewnRays {
  static constexpr int kPieces = 256;
  std::vector<float> y_mm, margin_mm, x, y, margin, dx, dy, dz, normal_y, normal_z;

  StrewnRays(int count, double low_rad, double high_rad, double jitter_rad) {
    for (int i = 0; i <= kPieces; ++i) {
      normal_y.push_back(static_cast<float>(std::sin(0.01 * i - 1.3)));
      normal_z.push_back(static_cast<float>(std::cos(0.01 * i - 1.3)));
    }
    for (int i = 0; i < count; ++i) {
      Rng rng(151, Stream::kTest, static_cast<std::uint64_t>(i));
      const double angle =
          low_rad + (high_rad - low_rad) * i / count + rng.uniform(-jitter_rad, jitter_rad);
      y_mm.push_back(static_cast<float>(100.0 * std::cos(angle)));
      margin_mm.push_back(static_cast<float>(100.0 * std::sin(angle)));
      x.push_back(static_cast<float>(rng.uniform(-1.0, 1.0)));
      y.push_back(i % 5 == 0 ? static_cast<float>(rng.uniform(-1.0, 1.0)) : 0.0F);
      margin.push_back(i % 7 == 0 ? static_cast<float>(rng.uniform(-1.0, 1.0)) : 0.0F);
      dx.push_back(static_cast<float>(rng.uniform(-0.5, 0.5)));
      dy.push_back(static_cast<float>(0.1 * rng.uniform(-1.0, 1.0)));
      dz.push_back(0.8F);
    }
  }

  /// Rays [first, first + count), added to nodes.
  void add(std::size_t first, int count, bool has_edges, std::vector<double>& by_node) const {
    add_shift_derivatives({.direction_x = &dx[first],
                           .direction_y = &dy[first],
                           .direction_z = &dz[first],
                           .count = count},
                          &y_mm[first],
                          &margin_mm[first],
                          {.x = &x[first],
                           .y = has_edges ? &y[first] : nullptr,
                           .margin = has_edges ? &margin[first] : nullptr},
                          {.y = normal_y.data(), .z = normal_z.data(), .pieces = kPieces},
                          by_node.data());
  }
};

// Few nodes and many, a drift that leaves the window of nodes again and again, rays all over the
// wall and at its feet: together as one by one.
TEST(AddShiftDerivatives, RaysTogetherAreRaysOneByOne) {
  const std::array<std::array<double, 3>, 5> ranges = {
      {{1.0, 1.001, 0.0}, {0.3, 2.9, 0.0}, {0.3, 2.9, 0.03}, {0.1, 3.0, 2.0}, {0.0, 0.1, 0.0}}};
  for (const auto& [low, high, jitter] : ranges) {
    const StrewnRays rays(2011, low, high, jitter);
    std::vector<double> together(StrewnRays::kPieces + 1), alone(together);
    rays.add(0, 2011, true, together);
    for (std::size_t i = 0; i < rays.x.size(); ++i) {
      rays.add(i, 1, true, alone);
    }
    for (std::size_t node = 0; node < alone.size(); ++node) {
      ASSERT_NEAR(together[node], alone[node], 3e-4) << low << " " << node;
    }
  }
}

TEST(AddShiftDerivatives, NoDerivativesByEdgesAreZero) {
  StrewnRays rays(500, 0.3, 2.9, 0.02);
  std::vector<double> without(StrewnRays::kPieces + 1), noughts(without);
  rays.add(0, 500, false, without);
  std::ranges::fill(rays.y, 0.0F);
  std::ranges::fill(rays.margin, 0.0F);
  rays.add(0, 500, true, noughts);
  EXPECT_EQ(without, noughts);
  EXPECT_NE(*std::ranges::max_element(without), 0.0);
}

}  // namespace
}  // namespace glint

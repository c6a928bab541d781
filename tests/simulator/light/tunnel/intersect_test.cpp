// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tunnel::intersect_block and hit_details: hits whose coordinates run on across the light's
// boundaries.
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "simulator/light/tunnel/tunnel.h"
#include "tests/simulator/light/tunnel/shaped_tunnel.h"

namespace glint {
namespace {

using Shape = TunnelSettings::Shape;

class IntersectBlock : public ::testing::TestWithParam<Shape> {
 protected:
  static TunnelSettings settings() { return test::raised_tunnel(GetParam(), 20.0); }
};

/// Rays and where they intersect the tunnel.
struct TunnelHits {
  std::array<std::vector<float>, 6> arrays;
  std::vector<float> x, y, margin, pattern, cosine;

  void add(const std::array<double, 6>& ray) {
    for (std::size_t k = 0; k < 6; ++k) {
      arrays[k].push_back(static_cast<float>(ray[k]));
    }
  }

  std::size_t size() const { return arrays[0].size(); }

  RayBlock block() const {
    return {.origin_x = arrays[0].data(),
            .origin_y = arrays[1].data(),
            .origin_z = arrays[2].data(),
            .direction_x = arrays[3].data(),
            .direction_y = arrays[4].data(),
            .direction_z = arrays[5].data(),
            .count = static_cast<int>(size())};
  }

  Ray ray(std::size_t i) const {
    return {.origin_mm = vector_of(arrays[0][i], arrays[1][i], arrays[2][i]),
            .direction = vector_of(arrays[3][i], arrays[4][i], arrays[5][i])};
  }

  void intersect(const Tunnel& tunnel) {
    for (auto* array : {&x, &y, &margin, &pattern, &cosine}) {
      array->resize(size());
    }
    tunnel.intersect_block(block(), x.data(), y.data(), margin.data());
    tunnel.hit_details(block(), x.data(), y.data(), margin.data(), pattern.data(), cosine.data());
  }

  bool is_lit(std::size_t i, double slot_mm) const {
    return margin[i] >= 0.0F && std::abs(static_cast<double>(y[i])) >= 0.5 * slot_mm;
  }
};

/// Rays of any direction from inside a part-sized box; a third of them downwards.
TunnelHits random_met(int count) {
  TunnelHits met;
  for (int i = 0; i < count; ++i) {
    Rng rng(61, Stream::kTest, static_cast<std::uint64_t>(i));
    const double azimuth = rng.uniform(0.0, 2.0 * kPi);
    const double z = rng.uniform(-0.5, 1.0);
    const double r = std::sqrt(1.0 - z * z);
    met.add({rng.uniform(-100, 100),
             rng.uniform(-25, 25),
             rng.uniform(4.0, 12.0),
             r * std::cos(azimuth),
             r * std::sin(azimuth),
             z});
  }
  return met;
}

TEST_P(IntersectBlock, AgreesWithTheExactHitWhereLit) {
  const Tunnel tunnel(settings());
  TunnelHits met = random_met(5003);
  met.intersect(tunnel);
  int disagreements = 0;
  int hits = 0;
  for (std::size_t i = 0; i < met.size(); ++i) {
    const auto exact = tunnel.hit(met.ray(i));
    if (exact.has_value() != met.is_lit(i, 20.0)) {
      ++disagreements;  // rounding to float right at a boundary
      continue;
    }
    if (exact) {
      ++hits;
      const double bound = 2e-4 + 2e-6 * exact->t_mm;
      EXPECT_NEAR(static_cast<double>(met.x[i]), exact->point_mm.x(), bound) << i;
      EXPECT_NEAR(static_cast<double>(met.y[i]), exact->point_mm.y(), bound) << i;
    }
  }
  EXPECT_GT(hits, 1000);
  EXPECT_LE(disagreements, 2);
}

// Without a slot the sign of the margin alone decides; 200 of 5,000 rays lie within 1 mm of it.
TEST_P(IntersectBlock, MarginIsNegativeExactlyOffTheWall) {
  TunnelSettings closed = settings();
  closed.slot_mm = 0.0;
  const Tunnel tunnel(closed);
  TunnelHits met = random_met(5003);
  met.intersect(tunnel);
  int off = 0;
  for (std::size_t i = 0; i < met.size(); ++i) {
    off += met.margin[i] < 0.0F ? 1 : 0;
    if (std::abs(met.margin[i]) > 1e-3F) {
      EXPECT_EQ(met.margin[i] >= 0.0F, tunnel.hit(met.ray(i)).has_value()) << i;
    }
  }
  EXPECT_GT(off, 500);
  EXPECT_LT(off, 4500);
}

/// A fan of rays in steps of `step_rad`, from below one rim over the top to below the other.
TunnelHits fan(double from_rad, double to_rad, double step_rad) {
  TunnelHits met;
  double angle = from_rad;
  while (angle < to_rad) {
    met.add({5.0, 4.0, 6.0, 0.3, std::sin(angle), std::cos(angle)});
    angle += step_rad;
  }
  return met;
}

// Over the slot and a rim three successive hits lie on a straight line up to the wall's curvature:
// a jump would be as large as the step itself or larger.
TEST_P(IntersectBlock, RunsOnSmoothlyOverSlotAndRim) {
  const Tunnel tunnel(settings());
  constexpr double kStep = 2e-3;
  // From -0.3 to 0.3 rad there is the slot; from 1.4 to 1.7 the rim, for flat panels (0.7 rad
  // leaning from 60 mm, 120 mm long) their upper end at 18.85 / 112.8: 0.1 to 0.3 rad.
  for (const auto& [from, to] : {std::pair{0.03, 0.3}, std::pair{1.3, 1.72}}) {
    if (GetParam() == Shape::kSuperellipse && from > 1.0) {
      continue;  // its corner at the rim is as sharp as its exponent makes it
    }
    TunnelHits met = fan(from, to, kStep);
    met.intersect(tunnel);
    for (std::size_t i = 2; i < met.size(); ++i) {
      ASSERT_GT(met.margin[i], -1e10F) << i;
      for (const auto* values : {&met.x, &met.y, &met.margin}) {
        const auto at = [&](std::size_t k) { return static_cast<double>((*values)[k]); };
        const double bend = std::abs(at(i) - 2.0 * at(i - 1) + at(i - 2));
        // 130 mm * kStep = 0.26 mm a step. The flat margin has a ridge midway between its ends.
        ASSERT_LE(bend, 0.02) << "ray " << i << " at " << from + kStep * static_cast<double>(i);
      }
    }
  }
}

// So do oblique stripes over the rims of both sides: the arc goes on beyond its first point as
// beyond its last. A step is 0.26 mm of arc; an arc that turned back would bend by twice that.
TEST_P(IntersectBlock, ObliqueStripesRunOnSmoothlyOverBothRims) {
  TunnelSettings oblique = settings();
  oblique.orientation_rad = 0.6;
  const Tunnel tunnel(oblique);
  for (const auto& [from, to] :
       {std::pair{0.03, 0.3}, std::pair{-0.3, -0.03}, std::pair{1.3, 1.72}, {-1.72, -1.3}}) {
    if (GetParam() == Shape::kSuperellipse && std::abs(from) > 1.0) {
      continue;
    }
    TunnelHits met = fan(from, to, 2e-3);
    met.intersect(tunnel);
    for (std::size_t i = 2; i < met.size(); ++i) {
      const auto at = [&](std::size_t k) { return static_cast<double>(met.pattern[k]); };
      ASSERT_LE(std::abs(at(i) - 2.0 * at(i - 1) + at(i - 2)), 0.02)
          << "ray " << i << " of those from " << from;
    }
  }
}

TEST_P(IntersectBlock, DetailsFollowTheExactHit) {
  TunnelSettings oblique = settings();
  oblique.orientation_rad = 0.6;
  oblique.cosine_law = true;
  const Tunnel tunnel(oblique);
  TunnelHits met = random_met(3000);
  met.intersect(tunnel);
  int hits = 0;
  for (std::size_t i = 0; i < met.size(); ++i) {
    const auto exact = tunnel.hit(met.ray(i));
    if (!exact || !met.is_lit(i, 20.0)) {
      continue;
    }
    ++hits;
    const double along = exact->point_mm.x() * std::cos(0.6) + exact->arc_mm * std::sin(0.6);
    EXPECT_NEAR(static_cast<double>(met.pattern[i]), along, 1e-3 + 2e-6 * exact->t_mm) << i;
    const double cosine = std::abs(exact->normal.dot(met.ray(i).direction.normalized()));
    EXPECT_NEAR(static_cast<double>(met.cosine[i]), cosine, 2e-3) << i;
  }
  EXPECT_GT(hits, 500);
}

INSTANTIATE_TEST_SUITE_P(AllShapes,
                         IntersectBlock,
                         ::testing::Values(Shape::kFlat,
                                           Shape::kSemicylinder,
                                           Shape::kEllipse,
                                           Shape::kSuperellipse,
                                           Shape::kFree));

// Straight up from y = 60 in a circle of radius 100: 80 mm above the base, the margin. Straight
// down it is met 80 mm below. 9 mm beside the middle is in a slot of 20, and met all the same.
TEST(IntersectBlockByHand, CircleAndSlot) {
  const Tunnel tunnel({.shape = Shape::kSemicylinder, .radius_mm = 100.0, .slot_mm = 20.0});
  TunnelHits met;
  met.add({7.0, 60.0, 0.0, 0.0, 0.0, 1.0});
  met.add({7.0, 60.0, 0.0, 0.0, 0.0, -1.0});
  met.add({7.0, 9.0, 0.0, 0.0, 0.0, 1.0});
  met.intersect(tunnel);
  EXPECT_NEAR(met.margin[0], 80.0F, 1e-4F);
  EXPECT_NEAR(met.margin[1], -80.0F, 1e-4F);
  EXPECT_NEAR(met.y[2], 9.0F, 1e-5F);
  EXPECT_NEAR(met.margin[2], std::sqrt(10000.0F - 81.0F), 1e-4F);
}

// Upright panels 60 mm away and 100 mm high: at 30 mm the nearer end is 30 mm off, at 80 mm 20, at
// 130 mm the hit lies 30 mm beyond the end.
TEST(IntersectBlockByHand, PanelsMeasureTheMarginFromTheirNearestEnd) {
  const Tunnel tunnel(
      {.shape = Shape::kFlat, .distance_mm = 60.0, .panel_height_mm = 100.0, .slot_mm = 0.0});
  TunnelHits met;
  for (const double height : {30.0, 80.0, 130.0, -10.0}) {
    met.add({0.0, 0.0, 0.0, 0.0, 60.0, height});
  }
  met.intersect(tunnel);
  EXPECT_NEAR(met.margin[0], 30.0F, 1e-4F);
  EXPECT_NEAR(met.margin[1], 20.0F, 1e-4F);
  EXPECT_NEAR(met.margin[2], -30.0F, 1e-4F);
  EXPECT_NEAR(met.margin[3], -10.0F, 1e-4F);
}

// The cross-section is 100 + 120 + 100 mm long, 0 in its middle: 30 mm above its foot the right
// panel is at 160 - 30 = 130 mm, 80 mm above it at 80. Stripes along the tunnel count these.
TEST(IntersectBlockByHand, StripesAlongTheTunnelCountFromTheFootOfAnUprightPanelToItsTop) {
  const Tunnel tunnel({.shape = Shape::kFlat,
                       .distance_mm = 60.0,
                       .panel_height_mm = 100.0,
                       .slot_mm = 0.0,
                       .orientation_rad = 0.5 * kPi});
  TunnelHits met;
  for (const double height : {30.0, 80.0}) {
    met.add({7.0, 0.0, 0.0, 0.0, 60.0, height});
  }
  met.intersect(tunnel);
  EXPECT_NEAR(met.pattern[0], 130.0F, 1e-4F);
  EXPECT_NEAR(met.pattern[1], 80.0F, 1e-4F);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/tunnel_light.h"

#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/simulator/light/area/light_scenes.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Shape = TunnelSettings::Shape;

TunnelLight scan_of(const TunnelSettings& settings, int positions) {
  return {.name = "tunnel",
          .settings = settings,
          .positions = positions,
          .step_mm = settings.period_mm / std::cos(settings.orientation_rad) / positions};
}

/// One cross-section of each kind, with everything else that a tunnel can have.
std::vector<TunnelSettings> striped_tunnels() {
  std::vector<TunnelSettings> all(5);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].shape = static_cast<Shape>(i);
  }
  all[0].opening_rad = 0.7;
  all[0].panel_height_mm = 120.0;
  all[0].base_mm = -3.0;
  all[1].duty = 0.3;
  all[2].half_width_mm = 70.0;
  all[2].orientation_rad = 0.6;
  all[3].exponent = 5.0;
  all[3].dark_reflectance = 0.4;
  all[3].offset_mm = 5.7;
  all[4].control_mm = {70.0, 90.0, 120.0, 110.0, 100.0};
  all[4].orientation_rad = -0.3;
  all[4].cosine_law = true;
  return all;
}

/// The irradiance at the origin, facing up, of a wall of radiance 1 round it: the part of the unit
/// disc (Nusselt) over which it stands, cut at the ends, less the slot. The ends are seen at
/// x = s = h / sqrt(R^2 + h^2), and the strip |x| < s of the disc has the area
/// 2 (s sqrt(1 - s^2) + asin s), of which the slot takes w / (2 R).
TEST(TunnelLight, BrightSemicylinderIlluminatesItsAxisAsTheClosedFormSays) {
  for (const double slot_mm : {0.0, 20.0}) {
    const Lights lights =
        lights_under({.radius_mm = 100.0, .length_mm = 300.0, .slot_mm = slot_mm, .duty = 1.0}, 1);
    ASSERT_EQ(lights.groups.size(), 1U);
    const double s = 150.0 / std::hypot(100.0, 150.0);
    const double strip = 2.0 * (s * std::sqrt(1.0 - s * s) + std::asin(s));
    const double expected = strip * (1.0 - 0.5 * slot_mm / 100.0);
    const double found = irradiance(lights, Vector3d::Zero(), Vector3d::UnitZ(), 200)[0];
    EXPECT_NEAR(found / expected, 1.0, 1e-3) << slot_mm;
  }
}

/// Aside of the axis, against the form factor summed over the exact wall.
TEST(TunnelLight, EveryCrossSectionIlluminatesAsItsExactWallDoes) {
  for (TunnelSettings settings : striped_tunnels()) {
    settings.duty = 1.0;
    settings.length_mm = 260.0;
    settings.cosine_law = false;
    const Tunnel tunnel(settings);
    const Vector3d point(20.0, -15.0, 12.0);
    const double expected = over_sphere(
        150,
        [&](const Vector3d& d) {
          const auto hit = tunnel.hit({.origin_mm = point, .direction = d});
          return hit && std::abs(hit->point_mm.x()) < 130.0 ? std::max(0.0, d.z()) : 0.0;
        },
        0.0);
    const double found = irradiance(lights_under(settings, 1), point, Vector3d::UnitZ(), 150)[0];
    EXPECT_NEAR(found / expected, 1.0, 2e-3) << shape_name(settings.shape);
  }
}

TEST(TunnelLight, BinsTogetherAreTheWholeWall) {
  const Vector3d point(20.0, -15.0, 12.0);
  for (const TunnelSettings& settings : striped_tunnels()) {
    const Lights striped = lights_under(settings, 7);
    const int groups = static_cast<int>(striped.groups.size());
    const double whole = irradiance(striped, point, Vector3d::UnitZ(), 100)[0];
    std::vector<double> of_bin(striped.wall->bin_ends.size(), 0.0);
    Rng rng(7, Stream::kTest, 1);  // the samples of irradiance()
    for (int i = 0; i < 100 * 100; ++i) {
      const int row = i / 100;
      const double u = (i % 100 + rng.uniform()) / 100;
      const double v = (row + rng.uniform()) / 100;
      const auto s = sample_light(striped, point, u, v);
      if (s && s->direction.z() > 0.0 && !is_occluded(striped, point, *s)) {
        ASSERT_GE(s->group, 0);
        ASSERT_LT(s->group, groups);
        of_bin[static_cast<std::size_t>(s->group) % of_bin.size()] +=
            static_cast<double>(s->radiance[0]) * s->direction.z() / s->density / 1e4;
      }
    }
    EXPECT_NEAR(std::accumulate(of_bin.begin(), of_bin.end(), 0.0), whole, 1e-9 * whole);
    // Stripes are narrow as seen from the part: a bin has about the share of its width.
    double begin = 0.0;
    for (std::size_t bin = 0; bin < of_bin.size(); ++bin) {
      const double width = striped.wall->bin_ends[bin] - begin;
      EXPECT_NEAR(of_bin[bin] / whole, width, 0.25 * width + 0.01) << shape_name(settings.shape);
      begin = striped.wall->bin_ends[bin];
    }
  }
}

TEST(TunnelFrameFactors, HaveOneBinAPositionWhereStripesEndOnPositions) {
  const auto factors = tunnel_frame_factors(scan_of({.duty = 0.5}, 8));
  ASSERT_EQ(factors.size(), 8U);
  // Frame 0 has the first half of the period bright; each step takes the stripes one bin further.
  EXPECT_EQ(factors[0], (std::vector<double>{1, 1, 1, 1, 0, 0, 0, 0}));
  for (std::size_t k = 0; k < 8; ++k) {
    for (std::size_t bin = 0; bin < 8; ++bin) {
      EXPECT_EQ(factors[k][(bin + k) % 8], factors[0][bin]);
    }
  }
}

// Edges at k / 3 and k / 3 + 0.25: bins end at 0.25, 1/3, 0.5833, 2/3, 0.9167 and 1.
TEST(TunnelFrameFactors, AreWholeWhereverStripesEnd) {
  const TunnelLight light = scan_of({.duty = 0.25}, 3);
  const auto factors = tunnel_frame_factors(light);
  EXPECT_EQ(factors[0], (std::vector<double>{1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(factors[1], (std::vector<double>{0, 0, 1, 0, 0, 0}));
  EXPECT_EQ(factors[2], (std::vector<double>{0, 0, 0, 0, 1, 0}));
  Lights lights;
  add_tunnel(light, lights);
  const std::vector<double> ends = {0.25, 1.0 / 3.0, 7.0 / 12.0, 2.0 / 3.0, 11.0 / 12.0, 1.0};
  ASSERT_EQ(lights.wall->bin_ends.size(), ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    EXPECT_NEAR(lights.wall->bin_ends[i], ends[i], 1e-12);
  }
  EXPECT_NEAR(lights.groups[0].factor, 1.0 / 3.0, 1e-12);  // bright in one frame of three
  EXPECT_EQ(lights.groups[1].factor, 0.0);
}

TEST(TunnelFrameFactors, KeepTheBrightShareOfEveryFrameWhenThereAreManyPositions) {
  for (const int positions : {60, 97, 200}) {
    const auto factors = tunnel_frame_factors(scan_of({.duty = 0.37}, positions));
    for (const auto& of_frame : factors) {
      ASSERT_EQ(of_frame.size(), static_cast<std::size_t>(kMaxTunnelBins));
      const double sum = std::accumulate(of_frame.begin(), of_frame.end(), 0.0);
      EXPECT_NEAR(sum / kMaxTunnelBins, 0.37, 1e-12);
      EXPECT_LE(std::ranges::count_if(of_frame, [](double f) { return f > 0.0 && f < 1.0; }), 2);
    }
  }
}

TEST(TunnelFrameFactors, AreTheDarkRadianceOnDarkStripes) {
  const TunnelLight light = scan_of({.dark_reflectance = 0.5}, 4);
  const DarkRadiance dark = Tunnel(light.settings).dark();
  const double low = dark.lowest();
  const double high = dark.highest();
  EXPECT_GT(low, 0.05);
  EXPECT_GT(high, 1.5 * low);
  EXPECT_EQ(tunnel_frame_factors(light)[0],
            (std::vector<double>{1, 1, low, low, 1, 1, high, high}));
}

TEST(TunnelFrameFactors, AreOneSetWhereOneValueStandsForAllPlaces) {
  const TunnelLight light = scan_of({.dark_reflectance = 0.02}, 4);
  const double dark = Tunnel(light.settings).dark().mean();
  EXPECT_GT(dark, 0.003);
  EXPECT_EQ(tunnel_frame_factors(light)[0], (std::vector<double>{1, 1, dark, dark}));
}

// The share of places in the second set grows from the darkest to the brightest; by hand for the
// semicylinder: none at the top's darkest stripe, all at the rim.
TEST(TunnelLight, PlacesGoToTheSecondSetAsOftenAsTheyAreBright) {
  const TunnelSettings settings = {.slot_mm = 0.0, .dark_reflectance = 0.5};
  const Lights lights = lights_under(settings, 4);
  ASSERT_EQ(lights.groups.size(), 8U);
  const Tunnel tunnel(settings);
  const DarkRadiance& dark = tunnel.dark();
  for (const double angle_rad : {0.05, 0.4, 0.9, 1.3, 1.52}) {
    const Vector3d direction(0.0, std::sin(angle_rad), std::cos(angle_rad));
    int second = 0;
    constexpr int kPlaces = 20000;
    for (int i = 0; i < kPlaces; ++i) {
      const Ray ray = {.origin_mm = {0.01 * i - 100.0, 0.0, 0.0}, .direction = direction};
      const auto hit = hit_light(lights, ray);
      ASSERT_TRUE(hit.has_value());
      second += hit->group - lights.first_tunnel_group >= 4 ? 1 : 0;
    }
    const double place = tunnel.dark_at({100.0 * direction.y(), 100.0 * direction.z()});
    const double expected = (place - dark.lowest()) / (dark.highest() - dark.lowest());
    // Four standard deviations of so many coins.
    EXPECT_NEAR(static_cast<double>(second) / kPlaces, expected, 0.015) << angle_rad;
  }
}

// A panel's dark stripes are brightest between its ends: a straight line between these would be
// wrong by the whole of it. Walls whose strips are short keep them.
TEST(TunnelLight, DarkStripesOfEveryCrossSectionHaveTheRadianceOfTheirPlace) {
  Rng rng(2, Stream::kTest, 9);
  for (TunnelSettings settings : striped_tunnels()) {
    const std::size_t strips = lights_under(settings, 1).emitters.size();
    settings.orientation_rad = 0.0;
    settings.dark_reflectance = 0.8;
    const Lights lights = lights_under(settings, 4);
    const StripedWall& wall = *lights.wall;
    const Tunnel tunnel(settings);
    const DarkRadiance& dark = tunnel.dark();
    ASSERT_FALSE(wall.second_share.empty());
    if (settings.shape == Shape::kFlat || settings.shape == Shape::kSemicylinder) {
      EXPECT_EQ(lights.emitters.size() > strips, settings.shape == Shape::kFlat);
    }
    for (int i = 0; i < 500; ++i) {
      const double angle_rad = rng.uniform(-1.5, 1.5);
      const Ray ray = {.origin_mm = {0.0, rng.uniform(-20.0, 20.0), 5.0},
                       .direction = {0.0, std::sin(angle_rad), std::cos(angle_rad)}};
      const auto hit = hit_light(lights, ray);
      if (!hit) {
        continue;  // through the slot
      }
      const Vector3d point = ray.origin_mm + hit->distance_mm * ray.direction;
      const auto emitter = static_cast<std::size_t>(hit->emitter - wall.first_emitter);
      const double second =
          wall.second_share[emitter] + wall.second_share_per_mm[emitter] *
                                           wall.along[emitter].dot(point - wall.middle_mm[emitter]);
      EXPECT_NEAR(dark.lowest() + second * (dark.highest() - dark.lowest()),
                  tunnel.dark_at(point.tail<2>()),
                  1e-3)
          << shape_name(settings.shape) << " " << point.transpose();
    }
  }
}

/// What level 0 sees along a ray in one frame; the distance to the next edge of a stripe in
/// periods.
struct SeenStripe {
  double radiance = 0.0;
  double to_edge = 0.0;
};

SeenStripe seen_stripe(const Tunnel& tunnel, const WallHit& hit, const Ray& ray, double shift_mm) {
  const TunnelSettings& s = tunnel.settings();
  const double q =
      hit.point_mm.x() * std::cos(s.orientation_rad) + hit.arc_mm * std::sin(s.orientation_rad);
  const double v = (q - shift_mm * std::cos(s.orientation_rad) - s.offset_mm) / s.period_mm;
  const double f = v - std::floor(v);
  const double law = s.cosine_law ? -hit.normal.dot(ray.direction) : 1.0;
  return {.radiance = law * (f < s.duty ? 1.0 : tunnel.dark_at(hit.point_mm.tail<2>())),
          .to_edge = std::min({f, std::abs(f - s.duty), 1.0 - f})};
}

/// In all frames, every ray from inside meets what level 0 says it meets.
TEST(TunnelLight, ShowsRaysTheStripesOfLevel0InEveryFrame) {
  constexpr int kPositions = 5;
  Rng rng(2, Stream::kTest, 8);
  for (const TunnelSettings& settings : striped_tunnels()) {
    const TunnelLight light = scan_of(settings, kPositions);
    const Lights lights = lights_under(settings, kPositions);
    const auto factors = tunnel_frame_factors(light);
    const Tunnel tunnel(settings);
    int compared = 0;
    int on_edge = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto within = [&](double low, double high) {
        return low + rng.uniform() * (high - low);
      };
      const Vector3d way(within(-1.0, 1.0), within(-1.0, 1.0), within(0.1, 1.0));
      const Ray ray = {.origin_mm = {within(-40, 40), within(-30, 30), within(0, 20)},
                       .direction = way.normalized()};
      const auto exact = tunnel.hit(ray);
      const auto hit = hit_light(lights, ray);
      if (!exact || !hit) {
        on_edge += exact.has_value() != hit.has_value() ? 1 : 0;
        continue;
      }
      EXPECT_NEAR(hit->distance_mm, exact->t_mm, 0.3);
      const StripedWall& wall = *lights.wall;
      const auto group = static_cast<std::size_t>(hit->group - lights.first_tunnel_group);
      const std::size_t bins = wall.bin_ends.size();
      const auto emitter = static_cast<std::size_t>(hit->emitter - wall.first_emitter);
      const Vector3d from_middle =
          ray.origin_mm + hit->distance_mm * ray.direction - wall.middle_mm[emitter];
      const double second =
          wall.second_share.empty()
              ? 0.0
              : wall.second_share[emitter] +
                    wall.second_share_per_mm[emitter] * wall.along[emitter].dot(from_middle);
      for (std::size_t k = 0; k < kPositions; ++k) {
        const SeenStripe seen =
            seen_stripe(tunnel, *exact, ray, static_cast<double>(k) * light.step_mm);
        const std::vector<double>& of = factors[k];
        const double mean =
            (1.0 - second) * of[group % bins] + second * of[of.size() - bins + group % bins];
        const double found = mean * static_cast<double>(hit->radiance[0]);
        ++compared;
        if (std::abs(found - seen.radiance) > 0.03) {
          EXPECT_LT(seen.to_edge, 0.02) << shape_name(settings.shape);
          ++on_edge;
        }
      }
    }
    EXPECT_GT(compared, 5000) << shape_name(settings.shape);
    EXPECT_LT(on_edge, compared / 100) << shape_name(settings.shape);
  }
}

TEST(TunnelLight, StandsInTheMiddleOfItsScanWithItsSlotOpen) {
  const Lights lights = lights_under({.length_mm = 200.0, .slot_mm = 20.0, .period_mm = 16.0}, 5);
  // Five steps of 3.2 mm: the middle of the scan is 6.4 mm from its start.
  Eigen::AlignedBox3d box;
  for (const Emitter& e : lights.emitters) {
    box.extend(bounds_mm(e.shape));
  }
  EXPECT_NEAR(box.min().x(), 6.4 - 100.0, 1e-9);
  EXPECT_NEAR(box.max().x(), 6.4 + 100.0, 1e-9);
  const auto looks_up = [&](double y_mm) {
    return hit_light(lights, {.origin_mm = {0.0, y_mm, 0.0}, .direction = Vector3d::UnitZ()});
  };
  EXPECT_FALSE(looks_up(9.999));
  EXPECT_TRUE(looks_up(10.001));
  EXPECT_FALSE(looks_up(-9.999));
  EXPECT_TRUE(looks_up(-10.001));
}

TEST(TunnelLight, HasOneRectangleForEachPanelAndTwoForACeilingWithASlot) {
  TunnelSettings flat = {.shape = Shape::kFlat, .slot_mm = 20.0};
  flat.opening_rad = 0.5;
  EXPECT_EQ(lights_under(flat).emitters.size(), 2U);
  flat.opening_rad = kPi;  // panels of 200 mm, cut to the 60 mm from their feet to the middle
  flat.base_mm = 80.0;
  const Lights ceiling = lights_under(flat);
  ASSERT_EQ(ceiling.emitters.size(), 2U);
  EXPECT_NEAR(area_mm2(ceiling.emitters[0].shape), 50.0 * 600.0, 1e-3);
  EXPECT_NEAR(area_mm2(ceiling.emitters[1].shape), 50.0 * 600.0, 1e-3);
}

TEST(TunnelLight, HidesTheCamerasViewAsTold) {
  for (const bool blocks : {true, false}) {
    const Lights lights = lights_under({.blocks_view = blocks});
    const Vector3d camera_mm(0.0, 40.0, 300.0);
    const auto met = hit_light(lights, {.origin_mm = camera_mm, .direction = -Vector3d::UnitZ()});
    ASSERT_EQ(met.has_value(), blocks);
    if (blocks) {
      EXPECT_LT(met->cosine, 0.0);
      EXPECT_EQ(met->radiance[0], 0.0F);
    }
  }
}

TEST(TunnelLight, GroupsComeAfterThoseOfOtherLights) {
  const Lights lights = build_lights(
      {{.name = "ring", .settings = RingSettings{}}}, {}, {}, scan_of({.duty = 0.5}, 4));
  ASSERT_EQ(lights.groups.size(), 5U);
  EXPECT_EQ(lights.first_tunnel_group, 1);
  EXPECT_EQ(lights.groups[0].name, "ring");
  EXPECT_EQ(lights.groups[1].name, "tunnel.0");
  EXPECT_EQ(lights.groups[4].name, "tunnel.3");
  EXPECT_EQ(lights.groups[4].factor, 0.5);
  EXPECT_FALSE(lights.is_of_wall(0)) << "the ring";
  EXPECT_TRUE(lights.is_of_wall(1) && lights.is_of_wall(4));
  const Lights none = build_lights({}, {}, {});
  EXPECT_EQ(none.first_tunnel_group, -1);
  EXPECT_FALSE(none.has_wall() || none.is_of_wall(0));
}

/// From the middle of its base a wall of length L = 2 h fills s = h / sqrt(R^2 + h^2) of the upper
/// half, less the slot: 0.95 * 0.94 at 600 mm, 0.29 * 0.94 at 60 mm.
TEST(TunnelLight, LeavesAWallAllRoundToTheMaterialsDirections) {
  for (const double length_mm : {600.0, 60.0}) {
    const Lights lights = build_lights({}, {}, {}, scan_of({.length_mm = length_mm}, 4));
    const bool is_drawn = length_mm < 100.0;
    EXPECT_EQ(sample_light(lights, Vector3d::Zero(), 0.3, 0.4).has_value(), is_drawn);
    const Ray ray = {.origin_mm = Vector3d::Zero(), .direction = Vector3d(0, 0.6, 0.8)};
    const auto hit = hit_light(lights, ray);
    ASSERT_TRUE(hit);
    EXPECT_EQ(light_density(lights, ray, *hit) > 0.0, is_drawn);
  }
}

TEST(TunnelLight, RefusesRadianceThatMovesWithTheTunnel) {
  const auto message = [](const TunnelSettings& settings) -> std::string {
    try {
      lights_under(settings);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(message({.led_ripple = 0.1}).find("lighting.tunnel.led_ripple: is 0.1"), 0U);
  EXPECT_EQ(message({.end_falloff = 0.2}).find("lighting.tunnel.end_falloff: is 0.2"), 0U);
  EXPECT_EQ(message({}), "");
}

}  // namespace
}  // namespace glint

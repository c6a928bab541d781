// SPDX-License-Identifier: GPL-3.0-or-later
//
// What every light must do, whatever its shape.
#include <array>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/simulator/light/area/light_scenes.h"

namespace glint {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr int kColumns = 24;
constexpr int kRows = 24;

std::size_t bin_of(const Vector3d& d) {
  const int row = std::clamp(static_cast<int>((1.0 - d.z()) / 2.0 * kRows), 0, kRows - 1);
  const double turns = std::atan2(d.y(), d.x()) / (2.0 * kPi);
  const int column =
      std::clamp(static_cast<int>((turns - std::floor(turns)) * kColumns), 0, kColumns - 1);
  return static_cast<std::size_t>(row * kColumns + column);
}

const Vector3d kNormal = Vector3d(0.1, 0.2, 1.0).normalized();

/// What rays in all directions from a point find.
struct Sweep {
  std::vector<double> shares = std::vector<double>(kRows * kColumns, 0.0);  ///< density, by bins
  double irradiance = 0.0;  ///< of the second channel
};

/// Rays in the cone around the emitters' box, or everywhere.
Sweep sweep(const LightCase& c, const Vector3d& point_mm) {
  const int n = kRows * 36;
  Eigen::AlignedBox3d box;
  for (const Emitter& e : c.lights.emitters) {
    box.extend(bounds_mm(e.shape));
  }
  const Vector3d way = c.lights.environment ? Vector3d::Zero() : Vector3d(box.center() - point_mm);
  const double sine = c.lights.environment ? 1.0 : 0.5 * box.diagonal().norm() / way.norm();
  // A little beside the middle, so that no round edge runs along the cells.
  constexpr double kAside_rad = 0.05;
  const bool is_cone = sine < 0.9;
  const double low_z = is_cone ? std::cos(std::asin(sine) + kAside_rad) : -1.0;
  const EmitterFrame middle = frame_around({}, way.normalized());
  const Vector3d pole = is_cone ? middle.global({std::sin(kAside_rad), 0.0, std::cos(kAside_rad)})
                                : Vector3d(0.8, 0.59, 0.1).normalized();
  const EmitterFrame skew = frame_around({}, pole);
  const double cell_sr = 2.0 * kPi * (1.0 - low_z) / (2.0 * n * n);
  Sweep result;
  const auto look = [&](const Vector3d& turned) {
    const Vector3d d = skew.global(turned);
    const Ray ray = {.origin_mm = point_mm, .direction = d};
    if (const auto hit = hit_light(c.lights, ray)) {
      result.shares[bin_of(d)] += light_density(c.lights, ray, *hit) * cell_sr;
      result.irradiance +=
          static_cast<double>(hit->radiance[1]) * std::max(0.0, d.dot(kNormal)) * cell_sr;
    }
    return 0.0;
  };
  over_sphere(n, look, low_z);
  return result;
}

struct SweptCase {
  LightCase light;
  std::vector<Sweep> sweeps;  ///< one a point
};

const std::vector<SweptCase>& swept_lights() {
  static const std::vector<SweptCase> all = [] {
    std::vector<SweptCase> made;
    for (LightCase c : every_light()) {
      SweptCase swept = {.light = std::move(c)};
      for (const Vector3d& point : swept.light.points_mm) {
        swept.sweeps.push_back(sweep(swept.light, point));
      }
      made.push_back(std::move(swept));
    }
    return made;
  }();
  return all;
}

struct ChiSquare {
  double value = 0.0;
  int freedom = 0;

  /// Wilson and Hilferty: a standard normal number when the model holds.
  double z_score() const {
    const double k = freedom;
    return (std::cbrt(value / k) - (1.0 - 2.0 / (9.0 * k))) / std::sqrt(2.0 / (9.0 * k));
  }
};

/// Bins with few expected samples and samples that reach nothing share one bin.
/// @param tilt  of the samples away from what the density says, as negative control
ChiSquare chi_square(const SweptCase& c, std::size_t at, int samples, double tilt) {
  const Lights& lights = c.light.lights;
  std::vector<double> counts(kRows * kColumns, 0.0);
  Rng rng(11, Stream::kTest, 3);
  for (int i = 0; i < samples; ++i) {
    const double u = std::pow(rng.uniform(), 1.0 + tilt);
    const auto s = sample_light(lights, c.light.points_mm[at], u, rng.uniform());
    if (s && !is_occluded(lights, c.light.points_mm[at], *s)) {
      ++counts[bin_of(s->direction)];
    }
  }
  ChiSquare result;
  double rest_expected = samples;
  double rest_count = samples;
  const auto add = [&result](double count, double expected) {
    result.value += (count - expected) * (count - expected) / expected;
    ++result.freedom;
  };
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double expected = c.sweeps[at].shares[i] * samples;
    if (expected > 20.0) {
      add(counts[i], expected);
      rest_expected -= expected;
      rest_count -= counts[i];
    }
  }
  if (rest_expected > 100.0) {
    add(rest_count, rest_expected);
  }
  return result;
}

TEST(EveryLight, DensityIntegratesToTheShareOfSamplesThatReachTheLight) {
  for (const SweptCase& c : swept_lights()) {
    for (std::size_t at = 0; at < c.sweeps.size(); ++at) {
      const auto& shares = c.sweeps[at].shares;
      const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
      Rng rng(5, Stream::kTest, 2);
      constexpr int kSamples = 20000;
      int reached = 0;
      for (int i = 0; i < kSamples; ++i) {
        const double u = rng.uniform();
        const auto s = sample_light(c.light.lights, c.light.points_mm[at], u, rng.uniform());
        reached += s && !is_occluded(c.light.lights, c.light.points_mm[at], *s) ? 1 : 0;
      }
      EXPECT_NEAR(sum, static_cast<double>(reached) / kSamples, 0.005) << c.light.name;
      EXPECT_GT(reached, kSamples / 2) << c.light.name;
    }
  }
}

TEST(EveryLight, SamplesFollowTheDensity) {
  for (const SweptCase& c : swept_lights()) {
    for (std::size_t at = 0; at < c.sweeps.size(); ++at) {
      EXPECT_LT(chi_square(c, at, 20000, 0.0).z_score(), 4.5) << c.light.name;
    }
  }
}

TEST(EveryLight, SamplesThatDoNotFollowTheDensityAreNoticed) {
  for (const SweptCase& c : swept_lights()) {
    EXPECT_GT(chi_square(c, 1, 20000, 0.2).z_score(), 8.0) << c.light.name;
  }
}

TEST(EveryLight, SampleAndHitAgree) {
  for (const LightCase& c : every_light()) {
    Rng rng(3, Stream::kTest, 4);
    int compared = 0;
    int lost = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vector3d& point = c.points_mm[static_cast<std::size_t>(i % 2)];
      const double u = rng.uniform();
      const auto s = sample_light(c.lights, point, u, rng.uniform());
      if (!s || is_occluded(c.lights, point, *s)) {
        continue;
      }
      const Ray ray = {.origin_mm = point, .direction = s->direction};
      const auto hit = hit_light(c.lights, ray);
      ++compared;
      if (!hit || hit->emitter != s->emitter) {
        ++lost;  // on an edge
        continue;
      }
      if (std::isfinite(s->distance_mm)) {
        EXPECT_NEAR(hit->distance_mm, s->distance_mm, 1e-8 * s->distance_mm) << c.name;
      }
      EXPECT_EQ(hit->group, s->group);
      const float minimum = 1e-5F * s->radiance.maxCoeff() + 1e-12F;
      EXPECT_LT((hit->radiance - s->radiance).abs().maxCoeff(), minimum) << c.name;
      EXPECT_NEAR(light_density(c.lights, ray, *hit) / s->density, 1.0, 1e-6) << c.name;
    }
    EXPECT_GT(compared, 2000) << c.name;
    EXPECT_LE(lost, 2) << c.name;
  }
}

/// Irradiance from samples against the sum over directions of what rays meet.
TEST(EveryLight, SamplesAndRaysGiveTheSameIrradiance) {
  for (const SweptCase& c : swept_lights()) {
    for (std::size_t at = 0; at < c.sweeps.size(); ++at) {
      const double by_samples = irradiance(c.light.lights, c.light.points_mm[at], kNormal, 150)[1];
      EXPECT_NEAR(by_samples / c.sweeps[at].irradiance, 1.0, 0.005) << c.light.name;
    }
  }
}

TEST(EveryLight, GivesNoNanAtItsPlaneBehindItAndOnIt) {
  Rng rng(9, Stream::kTest, 5);
  for (const LightCase& c : every_light()) {
    std::vector<Vector3d> points = c.points_mm;
    for (const Emitter& e : c.lights.emitters) {
      const ShapePoint on = point_on(e.shape, rng.uniform(), rng.uniform());
      const EmitterFrame plane = frame_around(on.point_mm, on.normal);
      points.push_back(on.point_mm);
      points.emplace_back(on.point_mm + 50.0 * plane.x);
      points.emplace_back(on.point_mm + 500.0 * plane.y + 1e-12 * on.normal);
      points.emplace_back(on.point_mm - 30.0 * on.normal);
      points.emplace_back(on.point_mm + 1e-9 * on.normal);
    }
    for (const Vector3d& point : points) {
      for (int i = 0; i < 50; ++i) {
        const double u = rng.uniform();
        const auto s = sample_light(c.lights, point, u, rng.uniform());
        if (s) {
          EXPECT_TRUE(s->radiance.isFinite().all() && (s->radiance >= 0.0F).all()) << c.name;
          EXPECT_TRUE(std::isfinite(s->density) && s->density > 0.0) << c.name;
          EXPECT_NEAR(s->direction.norm(), 1.0, 1e-9) << c.name;
          const auto hit = hit_light(c.lights, {.origin_mm = point, .direction = s->direction});
          const double density =
              hit ? light_density(c.lights, {.origin_mm = point, .direction = s->direction}, *hit)
                  : 0.0;
          EXPECT_TRUE(std::isfinite(density) && density >= 0.0) << c.name;
        }
      }
    }
  }
}

/// What leaves the surfaces, integrated over area and directions.
TEST(EveryLight, FluxIsThePowerOfItsGroups) {
  for (const LightCase& c : every_light()) {
    if (c.lights.emitters.empty()) {
      continue;
    }
    Rng rng(1, Stream::kTest, 6);
    Array3d flux = Array3d::Zero();
    constexpr int kSamples = 4000;
    for (const Emitter& e : c.lights.emitters) {
      const double area_m2 = area_mm2(e.shape) * kM2PerMm2;
      for (int i = 0; i < kSamples; ++i) {
        const double u = rng.uniform();
        const EmitterFrame at = frame_around({}, point_on(e.shape, u, rng.uniform()).normal);
        // Cosine-weighted directions, stratified: density cos / pi.
        const double cosine = std::sqrt((i + 0.5) / kSamples);
        const double sine = std::sqrt(1.0 - cosine * cosine);
        const double phi = 2.0 * kPi * rng.uniform();
        const Vector3d out = at.global({sine * std::cos(phi), sine * std::sin(phi), cosine});
        flux += emitted_radiance(e, c.lights.bodies, cosine, out).cast<double>() *
                (kPi * area_m2 / kSamples);
      }
    }
    Array3d power = Array3d::Zero();
    for (const LightGroup& group : c.lights.groups) {
      power += group.power_w.cast<double>();
    }
    EXPECT_LT((flux / power - 1.0).abs().maxCoeff(), 0.01) << c.name;
  }
}

}  // namespace
}  // namespace glint

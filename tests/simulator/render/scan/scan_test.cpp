// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan/scan.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/simulator/render/render_fixtures.h"

namespace glint {
namespace {

const CameraSettings kCamera = {
    .width_px = 160, .height_px = 90, .object_pixel_mm = 0.4, .working_distance_mm = 300.0};

PartSettings curved_strip() {
  return {.shape = PartSettings::Shape::kStrip,
          .length_mm = 60.0,
          .width_mm = 34.0,
          .radius_along_mm = 400.0,
          .radius_across_mm = 40.0,
          .thickness_mm = 3.0};
}

// Everything above the part shines: whatever its shape, a mirror shows one grey value.
TEST(Scan, MirrorInAUniformSurroundGivesAUniformImage) {
  const test::Bench bench(curved_strip(), kCamera, {});
  const Tunnel tunnel({.shape = TunnelSettings::Shape::kSemicylinder,
                       .base_mm = -60.0,
                       .radius_mm = 200.0,
                       .length_mm = 5000.0,
                       .slot_mm = 0.0,
                       .duty = 1.0,
                       .blocks_view = false});
  const Sensor sensor({.gain = 0.8, .blur_px = 0.0, .bits = 0}, 160, 90);
  const ScanResult scan = take_scan(bench.rays, tunnel, sensor, {.positions = 3}, bench.camera_mm);
  int on_part = 0;
  for (std::size_t i = 0; i < scan.aspect.size(); ++i) {
    if (bench.rays.coverage.values()[i] > 0.999F) {
      EXPECT_NEAR(scan.aspect.values()[i], 0.8F, 1e-6F) << i;
      ++on_part;
    }
  }
  EXPECT_GT(on_part, 5000);
}

TEST(Scan, FrameIsWhatSingleRaysSay) {
  const test::Bench bench(curved_strip(), kCamera, {});
  const Tunnel tunnel({.shape = TunnelSettings::Shape::kEllipse,
                       .half_width_mm = 80.0,
                       .height_mm = 120.0,
                       .length_mm = 400.0,
                       .slot_mm = 30.0,
                       .period_mm = 11.0,
                       .duty = 0.4});
  const double shift_mm = 3.3;
  ImageF frame;
  const WallRays wall = intersect_wall(bench.rays, tunnel, bench.camera_mm);
  ASSERT_EQ(wall.hidden_share, 0.0);
  render_frame(bench.rays, wall, tunnel.pattern(shift_mm), frame);
  int differences = 0;
  for (int p = 0; p < static_cast<int>(bench.rays.num_pixels()); ++p) {
    double sum = 0.0;
    for (int s = 0; s < bench.rays.samples; ++s) {
      const auto i = static_cast<std::size_t>(s * bench.rays.num_pixels() + p);
      const auto hit = tunnel.hit(
          {.origin_mm =
               vector_of(bench.rays.origin_x[i], bench.rays.origin_y[i], bench.rays.origin_z[i]),
           .direction = vector_of(
               bench.rays.direction_x[i], bench.rays.direction_y[i], bench.rays.direction_z[i])});
      if (bench.rays.weight[i] <= 0.0F || !hit) {
        continue;
      }
      const double x = hit->point_mm.x() - shift_mm;
      const double phase = x / 11.0;
      sum += std::abs(x) < 200.0 && phase - std::floor(phase) < 0.4 ? 0.25 : 0.0;
    }
    differences +=
        std::abs(static_cast<double>(frame.values()[static_cast<std::size_t>(p)]) - sum) > 1e-5 ? 1
                                                                                                : 0;
  }
  // Float rounding may move a ray across a stripe's edge: less than one pixel in a thousand.
  EXPECT_LE(differences, 14);
}

// The camera 300 mm above looks through a slot at 120 mm: a part 34 mm wide needs a slot of
// 34 * (300 - 120) / 300 = 20.4 mm there. 26 mm hides nothing, 12 mm hides much.
TEST(Scan, AWallHidesThePartUnlessTheSlotIsWideEnough) {
  const test::Bench bench(curved_strip(), kCamera, {});
  const Sensor sensor({}, 160, 90);
  for (const auto& [slot_mm, hides] : {std::pair{26.0, false}, std::pair{12.0, true}}) {
    const Tunnel tunnel(
        {.shape = TunnelSettings::Shape::kSemicylinder, .radius_mm = 120.0, .slot_mm = slot_mm});
    const ScanResult scan =
        take_scan(bench.rays, tunnel, sensor, {.positions = 1}, bench.camera_mm);
    if (hides) {
      EXPECT_NEAR(scan.hidden_share, 1.0 - 12.0 / 20.4, 0.05);
    } else {
      EXPECT_EQ(scan.hidden_share, 0.0);
    }
  }
}

TEST(Scan, StepIsAPeriodOverAllPositionsUnlessGiven) {
  EXPECT_DOUBLE_EQ(scan_step_mm({.positions = 24}, {.period_mm = 12.0}), 0.5);
  EXPECT_DOUBLE_EQ(scan_step_mm({.positions = 24, .step_mm = 2.0}, {.period_mm = 12.0}), 2.0);
}

// Stripes at 60 degrees move along their normal by half the tunnel's way: the step doubles.
TEST(Scan, ObliqueStripesNeedALongerStepForAPeriod) {
  EXPECT_NEAR(
      scan_step_mm({.positions = 24}, {.period_mm = 12.0, .orientation_rad = 60.0 * kRadPerDeg}),
      1.0,
      1e-12);
  EXPECT_THROW(scan_step_mm({.positions = 24}, {.orientation_rad = 90.0 * kRadPerDeg}),
               ConfigError);
}

// Whole periods under a linear sensor: a flawless mirror has the same mean everywhere, whatever the
// stripes' direction.
TEST(Scan, ObliqueStripesLeaveAFlawlessMirrorEven) {
  const test::Bench bench(curved_strip(), kCamera, {});
  const Sensor sensor({.blur_px = 0.0, .bits = 0}, 160, 90);
  for (const double degrees : {0.0, 30.0, -45.0}) {
    const Tunnel tunnel({.shape = TunnelSettings::Shape::kSemicylinder,
                         .base_mm = -60.0,
                         .radius_mm = 200.0,
                         .length_mm = 5000.0,
                         .slot_mm = 0.0,
                         .period_mm = 12.0,
                         .orientation_rad = degrees * kRadPerDeg,
                         .blocks_view = false});
    const ScanResult scan =
        take_scan(bench.rays, tunnel, sensor, {.positions = 24}, bench.camera_mm);
    int on_part = 0;
    int uneven = 0;
    for (std::size_t i = 0; i < scan.aspect.size(); ++i) {
      if (bench.rays.coverage.values()[i] == 1.0F) {
        ++on_part;
        // A ray on a stripe's edge may count once more or less: 1 / (24 * 4) of full scale.
        uneven += std::abs(scan.aspect.values()[i] - 0.5F) > 0.0105F ? 1 : 0;
      }
    }
    EXPECT_GT(on_part, 5000);
    EXPECT_LE(uneven, on_part / 500) << degrees;
  }
}

// Stripes turned by 90 degrees run along the tunnel: moving it changes nothing but the ends.
TEST(Scan, StripesAlongTheTunnelDoNotMove) {
  const test::Bench bench(curved_strip(), kCamera, {.rays_per_axis = 1});
  const Tunnel tunnel({.shape = TunnelSettings::Shape::kSemicylinder,
                       .radius_mm = 120.0,
                       .length_mm = 1000.0,
                       .slot_mm = 26.0,
                       .period_mm = 15.0,
                       .orientation_rad = 90.0 * kRadPerDeg});
  const WallRays wall = intersect_wall(bench.rays, tunnel, bench.camera_mm);
  ImageF first;
  ImageF later;
  render_frame(bench.rays, wall, tunnel.pattern(0.0), first);
  render_frame(bench.rays, wall, tunnel.pattern(6.0), later);
  EXPECT_EQ(first, later);
  const auto [low, high] = std::ranges::minmax(first.values());
  EXPECT_EQ(low, 0.0F);
  EXPECT_EQ(high, 1.0F);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan/scan_ripple.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "metrics/aspect_image/noise_variance.h"
#include "simulator/render/footprint/stripe_integral.h"
#include "simulator/render/scan/closed_scan.h"
#include "tests/simulator/render/render_fixtures.h"

namespace glint {
namespace {

struct Gradient {
  double gx = 0.0;
  double gy = 0.0;
};

/// Deviation of the mean over the frames, and its mean, over `places` phases at which a scan
/// begins: stripes of a linear phase through the real sensor, box pixels integrated exactly.
ScanRipple::Size size_by_sensor(const SensorSettings& settings,
                                const StripeSettings& stripes,
                                const Gradient& g) {
  constexpr int kPlaces = 32;
  const int radius = Sensor(settings, 9, 9).blur_radius_px();
  const int size = 2 * radius + 1;
  const Sensor sensor(settings, size, size);
  std::vector<double> means;
  for (int place = 0; place < kPlaces; ++place) {
    ScanSums sums;
    ImageF radiance(size, size);
    for (int k = 0; k < stripes.frames; ++k) {
      const double shift = (k + (place + 0.5) / kPlaces) / stripes.frames;
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          StripeSum pixel;
          pixel.add(PixelPolygon(), {.value = g.gx * x + g.gy * y, .dx = g.gx, .dy = g.gy});
          double share = 0.0;
          pixel.evaluate({shift}, stripes.duty, &share);
          radiance(x, y) = static_cast<float>(stripes.dark + (1.0 - stripes.dark) * share);
        }
      }
      sensor.accumulate(radiance, k, sums);
    }
    means.push_back(sums.sum(radius, radius) / stripes.frames);
  }
  double mean = 0.0;
  double squares = 0.0;
  for (const double value : means) {
    mean += value / kPlaces;
    squares += value * value / kPlaces;
  }
  const double w = std::sqrt(sensor.blur_variance_px2() + 1.0 / 12.0) * std::hypot(g.gx, g.gy);
  return {.deviation = std::sqrt(std::max(0.0, squares - mean * mean)) / mean,
          .bias = ClippedMean(settings, stripes).mean(w) / mean - 1.0};
}

// 16 positions and stripes of 64 to 8 px, at the middles of cells, so that nothing is rounded:
// along a row, and 30 degrees from it.
TEST(ScanRipple, IsWhatFewFramesLeaveOfALinearPhase) {
  for (const double gain : {1.5, 2.5}) {
    for (const double blur_px : {0.8, 1.25}) {
      const SensorSettings settings = {.gain = gain, .blur_px = blur_px, .bits = 0};
      const StripeSettings stripes = {.duty = 0.4, .dark = 0.05, .frames = 16};
      ScanRipple ripple(Sensor(settings, 9, 9), stripes);
      double largest = 0.0;
      for (const double turns : {4.0 / 16.0, 7.0 / 16.0, 12.0 / 16.0, 1.0, std::exp(0.5)}) {
        for (const double angle : {0.0, 30.0 * kRadPerDeg}) {
          const Gradient g = {.gx = turns / 16.0 * std::cos(angle),
                              .gy = -turns / 16.0 * std::sin(angle)};
          const ScanRipple::Size found = ripple.at(g.gx, g.gy);
          const ScanRipple::Size expected = size_by_sensor(settings, stripes, g);
          SCOPED_TRACE(::testing::Message() << "gain " << gain << ", blur " << blur_px << ", turns "
                                            << turns << ", angle " << angle);
          EXPECT_NEAR(found.deviation, expected.deviation, 4e-4 + 0.25 * expected.deviation);
          EXPECT_NEAR(found.bias, expected.bias, 4e-4 + 0.05 * expected.deviation);
          largest = std::max(largest, expected.deviation);
        }
      }
      EXPECT_GT(largest, 2e-3) << "something to be told";
    }
  }
}

// Anywhere between the cells, at any phase count from 4 to 30; blurs below 0.683 px are cut off at
// 0. Negative control: the ripple's size changes by more than half between neighbouring cells.
TEST(ScanRipple, IsRightBetweenItsCells) {
  Rng rng(64, Stream::kTest, 0);
  double largest = 0.0;
  double steepest = 0.0;
  for (int i = 0; i < 200; ++i) {
    const SensorSettings settings = {
        .gain = rng.uniform(0.9, 3.2), .blur_px = rng.uniform(0.45, 2.1), .bits = 0};
    const StripeSettings stripes = {.duty = rng.uniform(0.2, 0.8),
                                    .dark = i % 3 == 0 ? 0.3 : 0.0,
                                    .frames = 4 + static_cast<int>(rng.uniform(0.0, 26.0))};
    const Sensor sensor(settings, 9, 9);
    ScanRipple ripple(sensor, stripes);
    const double turns = rng.uniform(0.02, 0.35);
    const Gradient g = {.gx = turns / stripes.frames};
    const ScanRipple::Size found = ripple.at(g.gx, g.gy);
    const ScanRipple::Size expected = size_by_sensor(settings, stripes, g);
    SCOPED_TRACE(::testing::Message()
                 << i << ": gain " << settings.gain << ", blur " << settings.blur_px << ", turns "
                 << turns << ", frames " << stripes.frames << ", duty " << stripes.duty);
    EXPECT_NEAR(found.deviation, expected.deviation, 5e-4 + 0.2 * expected.deviation);
    EXPECT_NEAR(found.bias, expected.bias, 1.2e-3);
    largest = std::max(largest, expected.deviation);
    const double beyond = ripple.at(g.gx + 1.0 / 16.0 / stripes.frames, 0.0).deviation;
    steepest = std::max(steepest, std::abs(beyond / found.deviation - 1.0));
  }
  EXPECT_GT(largest, 0.05);
  EXPECT_GT(steepest, 0.5);
}

// 16 positions: at 1 / 16 of a period a pixel the ripple moves by a whole turn a pixel, at 1 / 32
// by half a one; at 0.058 by 0.93.
TEST(ScanRipple, IsCoherentWhereItMovesByWholeOrHalfTurnsAPixel) {
  const ScanRipple ripple(Sensor({.blur_px = 1.0}, 9, 9), {.frames = 16});
  EXPECT_TRUE(ripple.is_coherent(1.0 / 16.0, 0.0));
  EXPECT_TRUE(ripple.is_coherent(0.0, -1.0 / 16.0));
  EXPECT_TRUE(ripple.is_coherent(1.0 / 32.0, 1e-4));
  EXPECT_TRUE(ripple.is_coherent(0.0, 0.0));
  EXPECT_FALSE(ripple.is_coherent(0.058, 0.0));
  EXPECT_TRUE(ripple.is_coherent(0.06, 0.0));
  EXPECT_FALSE(ripple.is_coherent(0.002, 0.0));
  EXPECT_FALSE(ripple.is_coherent(1.0 / 16.0, 0.02));
}

// Two periods in 16 positions are eight phases.
TEST(ScanRipple, CountsThePhasesNotTheFrames) {
  const Sensor sensor({.gain = 2.0, .blur_px = 1.0}, 9, 9);
  ScanRipple eight(sensor, {.frames = 8});
  ScanRipple twice(sensor, {.frames = 16, .phases = 8});
  EXPECT_EQ(eight.at(0.03, 0.01).deviation, twice.at(0.03, 0.01).deviation);
  EXPECT_GT(eight.at(0.03, 0.01).deviation, 0.0);
  EXPECT_TRUE(twice.is_coherent(1.0 / 8.0, 0.0));
}

// Five frames, duty 0.5, even phase: a pixel is bright in 2 or 3 of them, half of the phases each:
// mean 0.5 and deviation 0.1, a fifth of it. With four frames it is always 2.
TEST(ScanRipple, FewFramesScatterByTheirPhase) {
  const Sensor sensor({.gain = 1.0, .bits = 0}, 9, 9);
  ScanRipple five(sensor, {.frames = 5});
  EXPECT_NEAR(five.at(0.0, 0.0).deviation, 0.2, 0.006);
  ScanRipple four(sensor, {.frames = 4});
  EXPECT_NEAR(four.at(0.0, 0.0).deviation, 0.0, 0.005);
}

TEST(ScanRipple, WithoutLightThereIsNone) {
  ScanRipple ripple(Sensor({}, 9, 9), {.gain = 0.0});
  EXPECT_EQ(ripple.at(0.05, 0.0).deviation, 0.0);
  EXPECT_EQ(ripple.at(0.05, 0.0).bias, 0.0);
}

/// A strip curved both ways that is larger than the picture, with rows along the stripes' normal.
struct AlignedStrip {
  Part part = build_part({.radius_along_mm = 600.0, .radius_across_mm = 40.0});
  Bvh bvh{part.mesh};
  CameraSettings camera = {
      .width_px = 240, .height_px = 90, .object_pixel_mm = 0.45, .working_distance_mm = 500.0};
  CornerRays rays;
  Eigen::Vector3d camera_mm{0.0, 0.0, 500.0};
  Region region;

  AlignedStrip() {
    ThreadPool pool(1);
    rays = trace_corner_rays(part,
                             bvh,
                             {},
                             PinholeCamera(intrinsics_of(camera)),
                             camera_from_world(default_viewpoint(camera)),
                             {},
                             pool);
    Mask pixels(camera.width_px, camera.height_px);
    for (int y = 2; y < camera.height_px - 2; ++y) {
      for (int x = 2; x < camera.width_px - 2; ++x) {
        pixels(x, y) = rays.coverage(x, y) >= 0.999F ? 1 : 0;
      }
    }
    region = Region(pixels);
  }

  static TunnelSettings light(double period_mm) {
    return {.radius_mm = 91.0, .slot_mm = 0.0, .period_mm = period_mm, .blocks_view = false};
  }

  /// In the middle of the picture.
  double periods_per_px() const {
    const Tunnel tunnel(light(1.0));
    const Footprints footprints(rays, tunnel, {.positions = 16}, camera_mm);
    const auto corner = static_cast<std::size_t>(45 * 241 + 120);
    const auto& stripes_mm = footprints.hits().stripes_mm();
    return std::abs(static_cast<double>(stripes_mm[corner + 1] - stripes_mm[corner]));
  }
};

struct SweepPoint {
  double worst_points = 0.0;    ///< of h_rms and h_abs, closed form and frames
  double without_points = 0.0;  ///< of h_rms, where nothing is known of few frames
  double frame_share = 0.0;
};

SweepPoint compare(const AlignedStrip& strip,
                   double period_mm,
                   int positions,
                   const SensorSettings& settings) {
  const Tunnel tunnel(AlignedStrip::light(period_mm));
  const ScanSettings scan = {.positions = positions};
  const Sensor sensor(settings, strip.camera.width_px, strip.camera.height_px);
  const Footprints footprints(strip.rays, tunnel, scan, strip.camera_mm);
  const ScanPlan plan = plan_scan(footprints, sensor, strip.region, {}, 1.0);
  const ClosedScan closed = scan_closed(footprints, sensor, plan);
  const ScanResult full = scan_integrated(footprints, sensor);
  const auto scored = [&](const ImageF& aspect) {
    return homogeneity(aspect, full.sums.clipped_frames, positions, strip.region, {}, false);
  };
  const Homogeneity exact = scored(full.aspect);
  const Homogeneity found = with_noise_variance(
      scored(closed.aspect), closed.aspect, closed.deviation, strip.region.mask);
  ImageF by_table = closed.aspect;
  for (std::size_t i = 0; i < by_table.size(); ++i) {
    by_table.values()[i] =
        static_cast<float>(plan.table->mean(static_cast<double>(plan.width.values()[i])));
  }
  const auto points = [](double a, double b) { return 100.0 * std::abs(a - b); };
  return {
      .worst_points = std::max(points(found.h_rms, exact.h_rms), points(found.h_abs, exact.h_abs)),
      .without_points = points(scored(by_table).h_rms, exact.h_rms),
      .frame_share = static_cast<double>(plan.form.frame_pixels) /
                     static_cast<double>(std::ranges::count(strip.region.mask.values(), 1))};
}

// A strip whose rows are along the stripes' normal: harmonics of the stripes alias where the number
// of positions meets the period in pixels. Positions over period from 0.5 to 2.2. Without regard
// of few frames h would be wrong by more than half a point.
TEST(ScanClosed, ScoresStripesThatAliasAsTheFullSequenceDoes) {
  const AlignedStrip strip;
  const double per_mm = strip.periods_per_px();
  double worst = 0.0;
  double without = 0.0;
  double frame_share = 0.0;
  int count = 0;
  for (int step = 0; step <= 85; ++step) {
    const double ratio = 0.5 + 0.02 * step;
    for (int i = 0; i < 6; ++i) {
      const int positions = std::array{14, 15, 16, 18, 9, 30}[static_cast<std::size_t>(i)];
      const int kind = step + i;
      const SensorSettings settings = {
          .gain = 1.5 + 0.3 * (kind % 6), .blur_px = 0.7 + 0.16 * (kind * 5 % 6), .bits = 0};
      // positions * per_mm / period = ratio
      const SweepPoint point = compare(strip, positions * per_mm / ratio, positions, settings);
      EXPECT_LE(point.worst_points, 0.1)
          << positions << " positions, ratio " << ratio << ", gain " << settings.gain << ", blur "
          << settings.blur_px << ", by frames " << point.frame_share;
      worst = std::max(worst, point.worst_points);
      without = std::max(without, point.without_points);
      frame_share += point.frame_share;
      ++count;
    }
  }
  RecordProperty("worst_points", std::to_string(worst));
  EXPECT_GT(without, 0.5);
  EXPECT_LT(frame_share / count, 0.5);
}

}  // namespace
}  // namespace glint

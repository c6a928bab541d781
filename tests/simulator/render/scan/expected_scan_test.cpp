// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan/expected_scan.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "simulator/render/corner_rays/changed_pixels.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

const test::FootprintBench& flawless_bench() {
  static const test::FootprintBench bench(test::bench_strip(), test::bench_camera());
  return bench;
}

const test::FootprintBench& dented_bench() {
  static const test::FootprintBench bench(test::bench_strip(), test::bench_camera(), 0.3);
  return bench;
}

/// Mean and deviation of each pixel's aspect value over many scans, against what is expected.
struct Comparison {
  double mean_z2 = 0.0;          ///< mean of (difference of means / standard error)^2
  double deviation_ratio = 0.0;  ///< root of the mean variance, expected over seen
};

Comparison compare(SensorSettings settings, int scans) {
  const CornerRays& rays = flawless_bench().rays;
  const Tunnel tunnel(test::bench_tunnel());
  const Footprints footprints(rays, tunnel, {.positions = 12}, flawless_bench().camera_mm);
  const ExpectedScan expected = expected_scan(footprints, settings);
  const std::size_t size = expected.aspect.size();
  std::vector<double> sum(size);
  std::vector<double> squares(size);
  for (int k = 0; k < scans; ++k) {
    settings.seed = 100 + k;
    const ImageF aspect =
        scan_integrated(footprints, Sensor(settings, rays.width_px, rays.height_px)).aspect;
    for (std::size_t i = 0; i < size; ++i) {
      const auto value = static_cast<double>(aspect.values()[i]);
      sum[i] += value;
      squares[i] += value * value;
    }
  }
  Comparison result;
  double seen_variance = 0.0;
  double expected_variance = 0.0;
  double counted = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    const double mean = sum[i] / scans;
    const auto deviation = static_cast<double>(expected.deviation.values()[i]);
    seen_variance += (squares[i] - scans * mean * mean) / (scans - 1);
    expected_variance += deviation * deviation;
    if (deviation > 1e-5) {
      const double z = (mean - static_cast<double>(expected.aspect.values()[i])) *
                       std::sqrt(static_cast<double>(scans)) / deviation;
      result.mean_z2 += z * z;
      counted += 1.0;
    }
  }
  result.mean_z2 /= counted;
  result.deviation_ratio = std::sqrt(expected_variance / seen_variance);
  return result;
}

// 40 scans of 20,000 pixels: the mean z^2 is 1 to 1 %, the ratio 1 to 0.1 %.
TEST(ExpectedScan, IsTheMeanAndScatterOfManyScans) {
  const Comparison fine = compare(
      {.gain = 1.4, .blur_px = 1.0, .bits = 12, .full_well_e = 8000.0, .read_noise_e = 10.0}, 40);
  EXPECT_NEAR(fine.mean_z2, 1.0, 0.06);
  EXPECT_NEAR(fine.deviation_ratio, 1.0, 0.01);
}

// Steps of 1/255 against read noise of a sixth of that: rounding is no scatter in the dark.
TEST(ExpectedScan, KnowsWhatCoarseStepsDo) {
  const Comparison coarse = compare(
      {.gain = 1.5, .blur_px = 1.0, .bits = 8, .full_well_e = 20000.0, .read_noise_e = 8.0}, 40);
  EXPECT_NEAR(coarse.mean_z2, 1.0, 0.1);
  EXPECT_NEAR(coarse.deviation_ratio, 1.0, 0.02);
}

TEST(ExpectedScan, OfASensorWithoutNoiseIsItsScan) {
  const CornerRays& rays = flawless_bench().rays;
  const Tunnel tunnel(test::bench_tunnel());
  const Footprints footprints(rays, tunnel, {.positions = 12}, flawless_bench().camera_mm);
  const SensorSettings settings = {.gain = 1.5, .bits = 8};
  const ExpectedScan expected = expected_scan(footprints, settings);
  const Sensor sensor(settings, rays.width_px, rays.height_px);
  EXPECT_EQ(expected.aspect, scan_integrated(footprints, sensor).aspect);
  EXPECT_EQ(std::ranges::count(expected.deviation.values(), 0.0F),
            static_cast<std::ptrdiff_t>(expected.deviation.size()));
}

TEST(ChangedPixels, AreNoneBetweenEqualRays) {
  const Mask changed = changed_pixels(flawless_bench().rays, flawless_bench().rays);
  EXPECT_EQ(std::ranges::count(changed.values(), 1), 0);
}

// A dent of sigma 0.3 mm reaches some sigmas; a pixel is 0.25 mm wide. Its middle lies at x 3, y
// 1.5 mm, and the picture is turned by 0.3 rad about the part's middle.
TEST(ChangedPixels, SurroundTheDent) {
  const Mask changed = changed_pixels(flawless_bench().rays, dented_bench().rays);
  const auto count = std::ranges::count(changed.values(), 1);
  EXPECT_GT(count, 16);   // 1 mm^2
  EXPECT_LT(count, 500);  // 6 sigmas around: 163
  double x_px = 0.0;
  double y_px = 0.0;
  for (int y = 0; y < changed.height(); ++y) {
    for (int x = 0; x < changed.width(); ++x) {
      x_px += changed(x, y) * (x + 0.5);
      y_px += changed(x, y) * (y + 0.5);
    }
  }
  const auto at = dented_bench().camera.project(
      dented_bench().camera_from_world *
      place_on_surface(dented_bench().part, dented_bench().bvh, 3.0, 1.5)->centre_mm);
  ASSERT_TRUE(at);
  EXPECT_NEAR(x_px / static_cast<double>(count), at->x(), 1.0);
  EXPECT_NEAR(y_px / static_cast<double>(count), at->y(), 1.0);
}

/// Every pixel whose frames differ by more than rays between nodes may
/// (simulator/render/corner_rays/sparse_rays.h) is among the changed ones.
TEST(ChangedPixels, AreAllThatFramesShow) {
  const Tunnel tunnel(test::bench_tunnel());
  const ScanSettings scan = {.positions = 6};
  const auto frames_of = [&](const test::FootprintBench& bench) {
    const Footprints footprints(bench.rays, tunnel, scan, bench.camera_mm);
    std::vector<ImageF> frames;
    const Sensor sensor({.blur_px = 0.0, .bits = 0}, bench.rays.width_px, bench.rays.height_px);
    scan_integrated(footprints, sensor, [&](int, const ImageF& frame) { frames.push_back(frame); });
    return frames;
  };
  const auto flawless = frames_of(flawless_bench());
  const auto dented = frames_of(dented_bench());
  const Mask changed = changed_pixels(flawless_bench().rays, dented_bench().rays);
  int different = 0;
  for (std::size_t k = 0; k < flawless.size(); ++k) {
    for (std::size_t i = 0; i < changed.size(); ++i) {
      constexpr float kBetweenNodes = 0.004F;
      if (std::abs(flawless[k].values()[i] - dented[k].values()[i]) > kBetweenNodes) {
        EXPECT_EQ(changed.values()[i], 1) << i;
        ++different;
      }
    }
  }
  EXPECT_GT(different, 20);
}

}  // namespace
}  // namespace glint

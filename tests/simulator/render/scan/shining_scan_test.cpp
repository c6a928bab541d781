// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scans under dark stripes whose light depends on the place, by the table and by all frames.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/simulator/render/scan/both_scans.h"

namespace glint {
namespace {

using Kind = ScanForm::Kind;

/// Deep and narrow: dark stripes are the darker the nearer to its rims.
TunnelSettings shining_tunnel(double dark_reflectance) {
  TunnelSettings light = test::bench_tunnel();
  light.shape = TunnelSettings::Shape::kEllipse;
  light.half_width_mm = 60.0;
  light.height_mm = 140.0;
  light.dark_reflectance = dark_reflectance;
  return light;
}

/// Both means score alike, and the table gives most of the region.
void expect_same_scores(const TunnelSettings& light,
                        const SensorSettings& sensor,
                        double bound_points) {
  const test::BothScans scans(light, sensor);
  ASSERT_FALSE(scans.footprints.positions().is_dark_even);
  ASSERT_EQ(scans.plan.form.kind, Kind::kTable);
  EXPECT_GT(scans.plan.form.table_pixels, 2 * scans.plan.form.frame_pixels);
  const test::Uniformity closed =
      test::uniformity_of(test::scattered(scans.closed()), scans.region);
  const test::Uniformity full = test::uniformity_of(scans.full().aspect, scans.region);
  fmt::print("gain {:.1f} blur {:.2f} dark {:.2f}: h_rms {:.4f} off {:.4f}, h_abs off {:.4f}\n",
             sensor.gain,
             sensor.blur_px,
             light.dark_reflectance,
             full.h_rms,
             std::abs(closed.h_rms - full.h_rms),
             std::abs(closed.h_abs - full.h_abs));
  EXPECT_NEAR(closed.h_rms, full.h_rms, bound_points);
  EXPECT_NEAR(closed.h_abs, full.h_abs, bound_points);
}

TEST(ShiningScan, ScoresUniformityAsTheFullSequenceDoes) {
  for (const double reflectance : {0.2, 0.6}) {
    for (const double gain : {1.1, 1.5, 2.5}) {
      expect_same_scores(
          shining_tunnel(reflectance), {.gain = gain, .blur_px = 1.0, .bits = 0}, 0.05);
    }
  }
}

TEST(ShiningScan, NoiseSpreadsTheTableAsItSpreadsTheFrames) {
  TunnelSettings light = shining_tunnel(0.6);
  light.slot_mm = 0.0;
  light.blocks_view = false;
  expect_same_scores(
      light,
      {.gain = 1.5, .blur_px = 1.0, .bits = 0, .full_well_e = 4000.0, .read_noise_e = 10.0},
      0.05);
}

TEST(ShiningScan, ANarrowBlurThatIsCutOffIsScoredAsTheFullSequence) {
  expect_same_scores(shining_tunnel(0.6), {.gain = 1.5, .blur_px = 0.55, .bits = 0}, 0.05);
}

// Dark stripes that reach full scale at some places and not at others.
TEST(ShiningScan, KnowsWhereEvenDarkStripesClip) {
  const TunnelSettings light = shining_tunnel(0.8);
  const test::BothScans scans(light, {.gain = 3.0, .blur_px = 1.0});
  const ClosedScan closed = scans.closed();
  const ScanResult full = scans.full();
  int saturated = 0;
  int others = 0;
  int differences = 0;
  double worst = 0.0;
  for (std::size_t i = 0; i < scans.region.size(); ++i) {
    if (scans.plan.by_table.values()[i] != 0) {
      const bool is_saturated = full.sums.clipped_frames.values()[i] == 24;
      saturated += is_saturated ? 1 : 0;
      others += is_saturated ? 0 : 1;
      differences += is_saturated != (closed.clipped_frames.values()[i] >= 24) ? 1 : 0;
      worst = std::max(worst,
                       std::abs(static_cast<double>(closed.aspect.values()[i]) -
                                static_cast<double>(full.aspect.values()[i])));
    }
  }
  fmt::print("{} saturated, {} not, {} told wrongly, worst mean off by {:.1e}\n",
             saturated,
             others,
             differences,
             worst);
  EXPECT_LT(worst, 4e-3);
  EXPECT_GT(saturated, 1000);
  EXPECT_GT(others, 1000);
  EXPECT_LE(differences, saturated / 50);
}

// Under a sensor that does not clip the mean radiance is linear in that of the dark stripes.
TEST(ShiningScan, ALinearSensorHasTheMeanRadiance) {
  const test::BothScans scans(shining_tunnel(0.6), {.gain = 0.9, .blur_px = 1.0, .bits = 0});
  ASSERT_EQ(scans.plan.form.kind, Kind::kMeanRadiance);
  const ClosedScan closed = scans.closed();
  const ScanResult full = scans.full();
  for (std::size_t i = 0; i < full.aspect.size(); ++i) {
    if (scans.region.values()[i] != 0) {
      ASSERT_NEAR(closed.aspect.values()[i], full.aspect.values()[i], 1e-5F) << i;
    }
  }
}

TEST(ShiningScan, WatchedPixelsSeeTheFramesOfTheFullScan) {
  const test::BothScans scans(
      shining_tunnel(0.6), {.gain = 2.0, .blur_px = 1.0}, {.positions = 24}, 0.02);
  const ClosedScan closed = scans.closed();
  const ScanResult full = scans.full();
  int watched = 0;
  for (std::size_t i = 0; i < scans.watched.size(); ++i) {
    if (scans.watched.values()[i] != 0) {
      ASSERT_EQ(closed.aspect.values()[i], full.aspect.values()[i]) << i;
      ++watched;
    }
  }
  EXPECT_GT(watched, 100);
}

}  // namespace
}  // namespace glint

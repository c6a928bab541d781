// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scans of a bench by closed forms and by all frames, and how even their means are.
#pragma once

#include <cmath>

#include "simulator/render/scan/closed_scan.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint::test {

inline const FootprintBench& closed_bench() {
  static const FootprintBench bench(bench_strip(), bench_camera(), 0.3);
  return bench;
}

/// Pixels wholly on the part, two off its rim and off the picture's border.
inline Mask region_of(const VisibilityBuffer& seen) {
  Mask outside(seen.width_px, seen.height_px);
  for (std::size_t i = 0; i < outside.size(); ++i) {
    outside.values()[i] = seen.coverage.values()[i] < 0.999F ? 1 : 0;
  }
  const Mask near = dilated(outside, 2);
  Mask region(seen.width_px, seen.height_px);
  for (int y = 2; y < seen.height_px - 2; ++y) {
    for (int x = 2; x < seen.width_px - 2; ++x) {
      region(x, y) = near(x, y) == 0 ? 1 : 0;
    }
  }
  return region;
}

/// Percent: 1 - deviation / mean and 1 - mean deviation / mean.
struct Uniformity {
  double h_rms = 0.0;
  double h_abs = 0.0;
};

inline Uniformity uniformity_of(const ImageF& aspect, const Mask& region) {
  double count = 0.0;
  double mean = 0.0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    count += region.values()[i] != 0 ? 1.0 : 0.0;
    mean += region.values()[i] != 0 ? static_cast<double>(aspect.values()[i]) : 0.0;
  }
  mean /= count;
  double squares = 0.0;
  double sizes = 0.0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region.values()[i] != 0) {
      const double d = static_cast<double>(aspect.values()[i]) - mean;
      squares += d * d;
      sizes += std::abs(d);
    }
  }
  return {.h_rms = 100.0 * (1.0 - std::sqrt(squares / count) / mean),
          .h_abs = 100.0 * (1.0 - sizes / count / mean)};
}

/// The aspect image as a scan would have taken it: each pixel somewhere around its value.
inline ImageF scattered(const ClosedScan& closed) {
  ImageF aspect = closed.aspect;
  for (std::size_t i = 0; i < closed.deviation.size(); ++i) {
    Rng rng(92, Stream::kTest, i);
    aspect.values()[i] += closed.deviation.values()[i] * static_cast<float>(rng.normal());
  }
  return aspect;
}

/// A scan of the bench both ways.
struct BothScans {
  Tunnel tunnel;
  Sensor sensor;
  Footprints footprints;
  Mask region;
  Mask watched;
  ScanPlan plan;

  BothScans(const TunnelSettings& light,
            const SensorSettings& settings,
            const ScanSettings& scan = {.positions = 24},
            double watched_share = 0.0)
      : tunnel(light),
        sensor(settings, closed_bench().rays.width_px, closed_bench().rays.height_px),
        footprints(closed_bench().rays, tunnel, scan, closed_bench().camera_mm),
        region(region_of(closed_bench().rays)),
        watched(region.width(), region.height()) {
    Rng rng(91, Stream::kTest, 0);
    for (auto& value : watched.values()) {
      value = rng.uniform() < watched_share ? 1 : 0;
    }
    plan = plan_scan(footprints, sensor, region, watched, 1.0);
  }

  ClosedScan closed(const FrameConsumer& consume = {}) const {
    return scan_closed(footprints, sensor, plan, consume);
  }

  ScanResult full(const FrameConsumer& consume = {}) const {
    return scan_integrated(footprints, sensor, consume);
  }
};

}  // namespace glint::test

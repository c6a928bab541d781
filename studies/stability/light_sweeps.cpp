// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sweeps of scan, stripes, sensor and tunnel, all by closed forms, footprints or frames.
#include "studies/stability/light_sweeps.h"

namespace glint::stability {
namespace {

Sweep keyed(const char* name,
            const char* key,
            const char* title,
            const std::vector<double>& values,
            std::vector<KeyValue> sets = {}) {
  return {.name = name,
          .swept = key,
          .title = title,
          .sets = std::move(sets),
          .values = key_values(key, values)};
}

/// How far the scan goes in periods, with 24 positions.
Sweep travel_over_period(const SweptScene& scene) {
  Sweep sweep{.name = "travel_over_period",
              .swept = "scan.positions * scan.step_mm / period_mm",
              .title = "how many periods the scan travels, with 24 positions",
              .sets = {{"scan.positions", "24"}}};
  for (const double periods : {1.0, 2.0, 1.5, 1.25, 0.5, 0.1, 0.01}) {
    sweep.values.push_back(
        {.value = periods,
         .sets = {{"scan.step_mm", number_text(periods * scene.period_mm / 24.0)}}});
  }
  return sweep;
}

Sweep stripe_over_pixel(const SweptScene& scene) {
  Sweep sweep{.name = "stripe_over_pixel",
              .swept = "lighting.tunnel.period_mm / camera.object_pixel_mm",
              .title = "stripes down to far below a pixel, at 24 positions"};
  for (const double ratio : {50.0, 13.0, 5.0, 2.0, 1.0, 0.5, 0.1667, 0.01}) {
    sweep.values.push_back(
        {.value = ratio,
         .sets = {{"lighting.tunnel.period_mm", number_text(ratio * scene.pixel_mm)}}});
  }
  return sweep;
}

/// The stripes' picture is far smaller than the stripes, by the curved mirror.
Sweep blur_over_stripe(const SweptScene& scene) {
  Sweep sweep{.name = "blur_over_stripe",
              .swept = "sensor.blur_px * camera.object_pixel_mm / lighting.tunnel.period_mm",
              .title = "blur from none to wider than the picture"};
  for (const double blur_px : {1.0, 0.0, 0.3, 0.5, 0.7, 3.0, 10.0, 30.0, 100.0}) {
    sweep.values.push_back({.value = blur_px * scene.pixel_mm / scene.period_mm,
                            .sets = {{"sensor.blur_px", number_text(blur_px)}}});
  }
  return sweep;
}

/// The strip's edge is 22.4 mm from the tunnel's axis.
Sweep wall_over_part() {
  Sweep sweep{.name = "wall_over_part",
              .swept = "lighting.tunnel.radius_mm / reach of the part",
              .title = "a tunnel that comes down on the part",
              .has_own_sizes = true,
              .sets = quiet_wall()};
  for (const double radius_mm : {200.0, 50.0, 30.0, 24.0, 22.6, 22.45, 22.0}) {
    sweep.values.push_back({.value = radius_mm / 22.4,
                            .sets = {{"lighting.tunnel.radius_mm", number_text(radius_mm)}}});
  }
  return sweep;
}

}  // namespace

std::vector<Sweep> light_sweeps(const SweptScene& scene) {
  Sweep slot = keyed("slot",
                     "lighting.tunnel.slot_mm",
                     "the camera's slot towards nothing",
                     {60, 32, 20, 10, 3, 1, 0.1, 0.0});
  slot.has_own_sizes = true;
  return {
      keyed("positions_over_period",
            "scan.positions",
            "pictures in one period of the stripes",
            {48, 24, 12, 8, 5, 4, 3, 2, 1}),
      travel_over_period(scene),
      stripe_over_pixel(scene),
      blur_over_stripe(scene),
      keyed("duty",
            "lighting.tunnel.duty",
            "bright share of a period",
            {0.5, 0.25, 0.1, 0.01, 0.001, 0.0}),
      slot,
      wall_over_part(),
      keyed("gain",
            "sensor.gain",
            "amplification to hard clipping",
            {0.5, 1, 1.5, 2, 3, 10, 100, 1e4, 1e6}),
      keyed("exposure",
            "sensor.exposure",
            "exposure towards no light",
            {1, 0.1, 0.01, 1e-4, 1e-6},
            {{"sensor.bits", "8"}}),
      keyed("full_well",
            "sensor.full_well_e",
            "electrons of a full pixel, down to one",
            {1e6, 2e4, 1e3, 100, 10, 3, 1}),
      keyed("bits", "sensor.bits", "rounding of grey values", {16, 12, 10, 8}),
  };
}

}  // namespace glint::stability

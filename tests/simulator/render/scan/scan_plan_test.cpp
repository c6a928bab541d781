// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan/scan_plan.h"

#include <gtest/gtest.h>

#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

using Kind = ScanForm::Kind;

Kind form_with(const TunnelSettings& light,
               const SensorSettings& sensor,
               double reflectance,
               const ScanSettings& scan = {.positions = 24}) {
  return form_of(ScanPositions(Tunnel(light), scan), sensor, reflectance);
}

// Gain 1 just reaches full scale, 1.5 clips, 1.5 on a part of reflectance 0.6 does not (0.9).
// Noise makes a frame at full scale lose its upper half: bias, so no floors.
TEST(FormOf, ClippingDecidesBetweenMeanRadianceAndTable) {
  const TunnelSettings light = test::bench_tunnel();
  EXPECT_EQ(form_with(light, {.gain = 1.0}, 1.0), Kind::kMeanRadiance);
  EXPECT_EQ(form_with(light, {.gain = 1.5}, 1.0), Kind::kTable);
  EXPECT_EQ(form_with(light, {.gain = 1.5}, 0.6), Kind::kMeanRadiance);
  EXPECT_EQ(form_with(light, {.exposure = 2.0, .gain = 0.7}, 1.0), Kind::kTable);
  EXPECT_EQ(form_with(light, {.gain = 1.0, .full_well_e = 1000.0}, 1.0), Kind::kTable);
  EXPECT_EQ(form_with(light, {.gain = 0.8, .full_well_e = 10000.0}, 1.0), Kind::kMeanRadiance);
}

// Below 0.683 px the blur is cut off at 0, which is not linear; the table is for what clips.
TEST(FormOf, ANarrowBlurHasNoMeanRadiance) {
  const TunnelSettings light = test::bench_tunnel();
  EXPECT_EQ(form_with(light, {.gain = 0.9, .blur_px = 0.7}, 1.0), Kind::kMeanRadiance);
  EXPECT_EQ(form_with(light, {.gain = 0.9, .blur_px = 0.6}, 1.0), Kind::kFrames);
  EXPECT_EQ(form_with(light, {.gain = 2.0, .blur_px = 0.6}, 1.0), Kind::kTable);
  EXPECT_EQ(form_with(light, {.gain = 0.9, .blur_px = 0.4}, 1.0), Kind::kFrames);
  EXPECT_EQ(form_with(light, {.gain = 0.9, .blur_px = 0.0}, 1.0), Kind::kMeanRadiance);
}

TEST(FormOf, BrokenPeriodsAndUnevenLightNeedFrames) {
  const TunnelSettings light = test::bench_tunnel();  // period 12 mm
  EXPECT_EQ(form_with(light, {}, 1.0, {.positions = 23, .step_mm = 0.5}), Kind::kFrames);
  EXPECT_EQ(form_with(light, {}, 1.0, {.positions = 48, .step_mm = 0.5}), Kind::kMeanRadiance);
  TunnelSettings ripple = light;
  ripple.led_ripple = 0.2;
  EXPECT_EQ(form_with(ripple, {}, 1.0), Kind::kFrames);
  TunnelSettings falloff = light;
  falloff.end_falloff = 0.2;
  EXPECT_EQ(form_with(falloff, {.gain = 2.0}, 1.0), Kind::kFrames);
}

TEST(FormName, IsAWordForEachKind) {
  EXPECT_EQ(form_name(Kind::kMeanRadiance), "floors");
  EXPECT_EQ(form_name(Kind::kTable), "table");
  EXPECT_EQ(form_name(Kind::kFrames), "frames");
}

}  // namespace
}  // namespace glint

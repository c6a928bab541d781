// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/distinct_stripes.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "simulator/render/footprint/footprint_frames.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

DistinctStripes stripes_of(double duty, int positions, double step_mm = 0.0, double ripple = 0.0) {
  TunnelSettings settings = test::bench_tunnel();  // a period of 12 mm
  settings.duty = duty;
  settings.led_ripple = ripple;
  settings.led_pitch_mm = 8.0;
  return ScanPositions(Tunnel(settings), {.positions = positions, .step_mm = step_mm})
      .distinct_stripes();
}

int num_opposite(const DistinctStripes& stripes) {
  return static_cast<int>(std::ranges::count_if(
      stripes.frames, [](const DistinctStripes::Frame& frame) { return frame.is_opposite; }));
}

// 0, 1/24 ... 12/24 are sources; frame 13 is opposite to frame 1, and so on to 23 and 11.
TEST(DistinctStripes, AreHalfOfThoseOfAnEvenScanAndOneMore) {
  const DistinctStripes stripes = stripes_of(0.5, 24);
  ASSERT_EQ(stripes.shift_periods.size(), 13U);
  EXPECT_EQ(stripes.opposite_of_first, 12U);
  EXPECT_EQ(num_opposite(stripes), 11);
  for (std::size_t k = 0; k < 24; ++k) {
    EXPECT_EQ(stripes.frames[k].source, k < 13 ? k : k - 12) << k;
    EXPECT_EQ(stripes.frames[k].is_opposite, k > 12) << k;
    EXPECT_NEAR(stripes.shift_periods[stripes.frames[k].source] +
                    (stripes.frames[k].is_opposite ? 0.5 : 0.0),
                static_cast<double>(k) / 24.0,
                1e-12);
  }
}

TEST(DistinctStripes, AreFoundAmongAsManyAsAScanMayHave) {
  const DistinctStripes stripes = stripes_of(0.5, 4096);
  EXPECT_EQ(stripes.shift_periods.size(), 2049U);
  EXPECT_EQ(stripes.frames.back().source, 2047U);
  EXPECT_TRUE(stripes.frames.back().is_opposite);
}

TEST(DistinctStripes, RepeatThemselvesOverSeveralPeriods) {
  const DistinctStripes two_periods = stripes_of(0.3, 24, 1.0);
  EXPECT_EQ(two_periods.shift_periods.size(), 12U);
  EXPECT_EQ(num_opposite(two_periods), 0);
  EXPECT_EQ(two_periods.frames[17].source, 5U);
  const DistinctStripes two_halves = stripes_of(0.5, 24, 1.0);
  EXPECT_EQ(two_halves.shift_periods.size(), 7U);
  EXPECT_EQ(num_opposite(two_halves), 10);
  EXPECT_EQ(two_halves.frames[17].source, 5U);  // 5 of 12
  EXPECT_FALSE(two_halves.frames[17].is_opposite);
  EXPECT_EQ(two_halves.frames[20].source, 2U);  // 8 of 12
  EXPECT_TRUE(two_halves.frames[20].is_opposite);
}

TEST(DistinctStripes, AreAllOfThemWhereNoneFollowFromOthers) {
  EXPECT_EQ(stripes_of(0.5, 25).shift_periods.size(), 25U) << "an odd number";
  EXPECT_EQ(stripes_of(0.49, 24).shift_periods.size(), 24U) << "bright and dark differ in width";
  EXPECT_EQ(stripes_of(0.5, 24, 0.37).shift_periods.size(), 24U) << "broken periods";
  EXPECT_EQ(stripes_of(0.5, 24, 0.0, 0.2).shift_periods.size(), 24U) << "the light moves, too";
  EXPECT_EQ(stripes_of(0.5, 1).shift_periods.size(), 1U);
  EXPECT_EQ(stripes_of(0.5, 2).shift_periods.size(), 2U);
}

// Sources at 0, 1/4 and 1/2 with 0.7, 0.2 and 0.4 of light: 1.1 in all, 0.9 of it at 3/4.
TEST(DistinctStripes, ExpandByHand) {
  const DistinctStripes stripes = stripes_of(0.5, 4);
  ASSERT_EQ(stripes.shift_periods.size(), 3U);
  const std::vector<double> of_sources = {0.7, 0.2, 0.4};
  std::vector<float> values = {5.0F};
  stripes.expand(of_sources.data(), values);
  ASSERT_EQ(values.size(), 5U);
  EXPECT_FLOAT_EQ(values[0], 5.0F);
  EXPECT_FLOAT_EQ(values[1], 0.7F);
  EXPECT_FLOAT_EQ(values[2], 0.2F);
  EXPECT_FLOAT_EQ(values[3], 0.4F);
  EXPECT_FLOAT_EQ(values[4], 0.9F);
}

// Over two periods frame 8 is opposite to frame 2, and frame 14 is equal to it.
TEST(DistinctStripes, GiveFramesTheSameBitsWhateverElseIsRendered) {
  const test::FootprintBench bench(test::bench_strip(), test::bench_camera(), 0.4);
  const Tunnel tunnel(test::bench_tunnel());
  const ScanSettings scan = {.positions = 24, .step_mm = 1.0};
  const Footprints footprints(bench.rays, tunnel, scan, bench.camera_mm);
  const std::vector<ImageF> whole = test::integrated_frames(footprints);
  const Spans all = whole_image(bench.rays.width_px, bench.rays.height_px);
  std::vector<ImageF> some(16, ImageF(bench.rays.width_px, bench.rays.height_px));
  FootprintFrames(footprints, all).render(8, some);
  for (std::size_t k = 0; k < some.size(); ++k) {
    EXPECT_TRUE(std::ranges::equal(some[k].values(), whole[k + 8].values())) << k + 8;
  }
}

// Of a few stretches of rows, in batches that begin anywhere: stripes of full contrast, dark ones
// that shine evenly, ends that pass, and an uneven light, of which nothing is kept.
TEST(DistinctStripes, GiveFramesTheSameBitsWhetherSourcesAreKeptOrNot) {
  const test::FootprintBench bench(test::bench_strip(), test::bench_camera(), 0.4);
  const Spans where = {{.y = 20, .begin = 3, .end = 180},
                       {.y = 21, .begin = 3, .end = 30},
                       {.y = 21, .begin = 60, .end = 199},
                       {.y = 50, .begin = 0, .end = 200}};
  for (int variant = 0; variant < 4; ++variant) {
    TunnelSettings settings = test::bench_tunnel();
    settings.duty = variant == 1 ? 0.3 : 0.5;
    settings.dark_reflectance = variant == 1 ? 0.2 : 0.0;
    settings.length_mm = variant == 2 ? 70.0 : settings.length_mm;
    settings.led_ripple = variant == 3 ? 0.1 : 0.0;
    const Tunnel tunnel(settings);
    const Footprints footprints(bench.rays, tunnel, {.positions = 24}, bench.camera_mm);
    const std::vector<ImageF> whole = test::integrated_frames(footprints);
    FootprintFrames keeping(footprints, where);
    keeping.keep_sources();
    for (const int first : {0, 5, 10, 15}) {
      std::vector<ImageF> some(9, ImageF(bench.rays.width_px, bench.rays.height_px));
      keeping.render(first, some);
      for (std::size_t k = 0; k < some.size(); ++k) {
        const ImageF& wanted = whole[static_cast<std::size_t>(first) + k];
        for (const RowSpan& span : where) {
          EXPECT_TRUE(std::equal(some[k].row(span.y) + span.begin,
                                 some[k].row(span.y) + span.end,
                                 wanted.row(span.y) + span.begin))
              << variant << ' ' << first << ' ' << k << ' ' << span.y;
        }
      }
    }
  }
}

// A duty off one half by a millionth has no opposite frames and the same light to a few millionths,
// over what a footprint is wide: slot, ends that pass, refined pixels and dark stripes that shine.
TEST(DistinctStripes, GiveTheFramesThatEachOfItsOwnStripesGives) {
  const test::FootprintBench bench(test::bench_strip(), test::bench_camera(), 0.4);
  TunnelSettings settings = test::bench_tunnel();
  settings.length_mm = 70.0;
  settings.dark_reflectance = 0.2;
  const auto frames_of = [&](double duty) {
    settings.duty = duty;
    const Tunnel tunnel(settings);
    const Footprints footprints(bench.rays, tunnel, {.positions = 24}, bench.camera_mm);
    EXPECT_EQ(num_opposite(footprints.positions().distinct_stripes()), duty == 0.5 ? 11 : 0);
    return test::integrated_frames(footprints);
  };
  const std::vector<ImageF> found = frames_of(0.5);
  const std::vector<ImageF> expected = frames_of(0.5 + 1e-6);
  for (std::size_t k = 0; k < found.size(); ++k) {
    for (std::size_t i = 0; i < found[k].size(); ++i) {
      ASSERT_NEAR(found[k].values()[i], expected[k].values()[i], 1e-4F) << "frame " << k;
    }
  }
}

}  // namespace
}  // namespace glint

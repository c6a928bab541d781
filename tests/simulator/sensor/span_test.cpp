// SPDX-License-Identifier: GPL-3.0-or-later
//
// A sensor that exposes some pixels gives them the bytes of the whole picture.
#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "core/image/spans.h"
#include "core/rng.h"
#include "simulator/sensor/sensor.h"

namespace glint {
namespace {

struct SpanCase {
  SensorSettings settings;
  int width = 0;
  int height = 0;
  Mask wanted;
  std::vector<ImageF> radiance;

  explicit SpanCase(std::uint64_t index) {
    Rng rng(51, Stream::kTest, index);
    width = 1 + static_cast<int>(rng.uniform(0.0, 60.0));
    height = 1 + static_cast<int>(rng.uniform(0.0, 25.0));
    settings.gain = rng.uniform(0.5, 3.0);
    settings.blur_px = index % 4 == 0 ? 0.0 : rng.uniform(0.3, 2.5);
    settings.bits = index % 3 == 0 ? 0 : 8;
    settings.seed = static_cast<int>(index);
    if (index % 2 == 0) {
      settings.full_well_e = index % 6 == 0 ? 60.0 : 8000.0;  // few electrons: counted exactly
      settings.read_noise_e = 5.0;
      settings.dark_e = 3.0;
    }
    wanted = Mask(width, height);
    const double share = rng.uniform();
    for (auto& value : wanted.values()) {
      value = rng.uniform() < share ? 1 : 0;
    }
    for (int k = 0; k < 2; ++k) {
      radiance.emplace_back(width, height);
      for (float& value : radiance.back().values()) {
        value = static_cast<float>(rng.uniform());
      }
    }
  }
};

TEST(SensorSpans, EqualTheWholePictureBitForBit) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const SpanCase c(i);
    const Sensor sensor(c.settings, c.width, c.height);
    ScanSums whole;
    ScanSums some;
    ImageF frame;
    ImageF part(c.width, c.height, -7.0F);
    for (int k = 0; k < 2; ++k) {
      const ImageF& radiance = c.radiance[static_cast<std::size_t>(k)];
      sensor.accumulate(radiance, k, whole, &frame);
      sensor.accumulate(radiance, k, spans_of(c.wanted), some, &part);
      for (std::size_t p = 0; p < frame.size(); ++p) {
        ASSERT_EQ(part.values()[p], c.wanted.values()[p] != 0 ? frame.values()[p] : -7.0F) << i;
      }
    }
    EXPECT_EQ(some.frames, 2);
    for (std::size_t p = 0; p < frame.size(); ++p) {
      const bool is_wanted = c.wanted.values()[p] != 0;
      ASSERT_EQ(some.sum.values()[p], is_wanted ? whole.sum.values()[p] : 0.0) << i;
      ASSERT_EQ(some.clipped_frames.values()[p], is_wanted ? whole.clipped_frames.values()[p] : 0)
          << i;
    }
  }
}

// What lies further away than the blur's radius may be anything, even no number.
TEST(SensorSpans, NeedTheRadianceOnlyWithinTheBlur) {
  for (std::uint64_t i = 0; i < 300; ++i) {
    const SpanCase c(i);
    const Sensor sensor(c.settings, c.width, c.height);
    Mask wanted(c.width, c.height);
    wanted(c.width / 2, c.height / 2) = 1;
    const Mask known = dilated(wanted, sensor.blur_radius_px());
    ImageF holes = c.radiance[0];
    for (std::size_t p = 0; p < holes.size(); ++p) {
      if (known.values()[p] == 0) {
        holes.values()[p] = std::numeric_limits<float>::quiet_NaN();
      }
    }
    ImageF frame;
    sensor.expose(c.radiance[0], 0, frame);
    ImageF part(c.width, c.height);
    ScanSums sums;
    sensor.accumulate(holes, 0, spans_of(wanted), sums, &part);
    ASSERT_EQ(part(c.width / 2, c.height / 2), frame(c.width / 2, c.height / 2)) << i;
  }
}

// sigma 1: weights 0.39894, 0.24197, 0.05399, 0.00443, 0.00013 of a sum of 1.
// Beyond 2 px lie 0.00456 (below 0.005), beyond 1 px 0.05855, beyond 3 px 0.00013.
TEST(Sensor, BlurReachesAsFarAsItsTailIsLarge) {
  const Sensor sensor({.blur_px = 1.0}, 9, 9);
  EXPECT_EQ(sensor.blur_radius_px(), 4);
  EXPECT_EQ(sensor.blur_reach_px(5e-3), 2);
  EXPECT_EQ(sensor.blur_reach_px(4e-3), 3);
  EXPECT_EQ(sensor.blur_reach_px(1e-9), 4);
  EXPECT_EQ(sensor.blur_reach_px(1.0), 0);
  EXPECT_EQ(Sensor({.blur_px = 0.0}, 9, 9).blur_reach_px(5e-3), 0);
}

// 2 (0.24197 + 4 * 0.05399 + 9 * 0.00443 + 16 * 0.00013) = 0.99982 of sigma^2 = 1: hardly cut.
TEST(Sensor, BlurVarianceIsThatOfItsWeights) {
  EXPECT_NEAR(Sensor({.blur_px = 1.0}, 9, 9).blur_variance_px2(), 1.0, 2e-3);
  EXPECT_NEAR(Sensor({.blur_px = 2.0}, 9, 9).blur_variance_px2(), 4.0, 8e-3);
  EXPECT_EQ(Sensor({.blur_px = 0.0}, 9, 9).blur_variance_px2(), 0.0);
}

// Wide pictures are blurred in strips; short spans end in the middle of vectors, the last at the
// picture's last pixel.
TEST(Expose, HasTheSameBytesInStripsAndInShortSpans) {
  constexpr int kWidth_px = 1511;
  constexpr int kHeight_px = 13;
  const Sensor sensor({.gain = 1.3, .blur_px = 1.0}, kWidth_px, kHeight_px);
  ImageF radiance(kWidth_px, kHeight_px);
  Rng rng(77, Stream::kTest, 0);
  for (float& value : radiance.values()) {
    value = static_cast<float>(rng.uniform());
  }
  ImageF whole, pieces(kWidth_px, kHeight_px);
  sensor.expose(radiance, 0, whole);
  Spans spans;
  for (int y = 0; y < kHeight_px; ++y) {
    for (int begin = 0; begin < kWidth_px; begin += 37) {
      spans.push_back({.y = y, .begin = begin, .end = std::min(begin + 37, kWidth_px)});
    }
  }
  sensor.expose(radiance, 0, spans, pieces);
  EXPECT_EQ(pieces, whole);
}

}  // namespace
}  // namespace glint

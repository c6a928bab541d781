// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/sensor/sensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/rng.h"

namespace glint {
namespace {

ImageF random_radiance(int width_px, int height_px, std::uint64_t index, double brightest = 1.0) {
  ImageF radiance(width_px, height_px);
  Rng rng(11, Stream::kTest, index);
  for (float& value : radiance.values()) {
    value = static_cast<float>(rng.uniform(0.0, brightest));
  }
  return radiance;
}

ImageF exposed(const SensorSettings& settings, const ImageF& radiance, int frame_index = 0) {
  ImageF frame;
  Sensor(settings, radiance.width(), radiance.height()).expose(radiance, frame_index, frame);
  return frame;
}

double total(const ImageF& image) {
  return std::accumulate(image.values().begin(), image.values().end(), 0.0);
}

// Gain 1.5: 0.1 -> 0.15 x 255 = 38.25 -> 38; 0.3 -> 114.75 -> 115; 0.5 -> 191.25 -> 191;
// 0.7 -> 1.05 -> clipped to 255. At exposure 3 and gain 0.5 the product is the same.
TEST(Sensor, MultipliesClipsAndRoundsAHandWorkedRow) {
  ImageF row(4, 1);
  row.values() = {0.1f, 0.3f, 0.5f, 0.7f};
  const std::vector<int> levels = {38, 115, 191, 255};
  const ImageF by_gain = exposed({.gain = 1.5, .blur_px = 0.0}, row);
  const ImageF by_exposure = exposed({.exposure = 3.0, .gain = 0.5, .blur_px = 0.0}, row);
  for (int x = 0; x < 4; ++x) {
    EXPECT_FLOAT_EQ(by_gain(x, 0),
                    static_cast<float>(levels[static_cast<std::size_t>(x)]) / 255.0f);
  }
  EXPECT_EQ(by_gain, by_exposure);
}

TEST(Sensor, FullScaleIsExactlyOneAndStepsAreThoseOfTheBitDepth) {
  for (const int bits : {8, 10, 12, 16}) {
    const int levels = (1 << bits) - 1;
    const ImageF radiance = random_radiance(50, 40, static_cast<std::uint64_t>(bits), 1.2);
    const ImageF frame = exposed({.blur_px = 0.0, .bits = bits}, radiance);
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const double steps = static_cast<double>(frame.values()[i]) * levels;
      EXPECT_NEAR(steps, std::round(steps), 0.01);
      const double wanted = std::min(1.0, static_cast<double>(radiance.values()[i]));
      EXPECT_NEAR(frame.values()[i], wanted, 0.5 / levels + 1e-6);
      if (radiance.values()[i] >= 1.0f) {
        EXPECT_EQ(frame.values()[i], 1.0f);
      }
    }
  }
}

// sigma 1, radius 4: exp(-1/2) = 0.606531, exp(-2) = 0.135335, exp(-9/2) = 0.011109,
// exp(-8) = 0.000335; 1 + 2 x 0.753310 = 2.506621; centre 1 / 2.506621^2 = 0.159156, next 0.606531
// x that = 0.096533.
TEST(Sensor, SpreadsAnImpulseAsAGaussianAndKeepsItsTotal) {
  ImageF impulse(21, 15);
  impulse(10, 7) = 1.0f;
  const ImageF spread = exposed({.blur_px = 1.0, .bits = 0}, impulse);
  EXPECT_NEAR(spread(10, 7), 0.159156, 2e-6);
  EXPECT_NEAR(spread(11, 7), 0.096533, 2e-6);
  EXPECT_NEAR(spread(10, 6), 0.096533, 2e-6);
  EXPECT_NEAR(total(spread), 1.0, 1e-6);
}

TEST(Sensor, KeepsAConstantImageUpToTheBorder) {
  for (const double blur_px : {0.0, 0.3, 0.7, 2.5, 9.0}) {
    const ImageF frame = exposed({.blur_px = blur_px, .bits = 0}, ImageF(17, 9, 0.37f));
    for (const float value : frame.values()) {
      EXPECT_NEAR(value, 0.37f, 1e-6f);
    }
  }
}

TEST(Sensor, IsLinearBelowFullScaleWithoutRounding) {
  const SensorSettings settings{.exposure = 0.8, .gain = 1.1, .blur_px = 1.3, .bits = 0};
  const ImageF a = random_radiance(60, 40, 1, 0.5);
  const ImageF b = random_radiance(60, 40, 2, 0.5);
  ImageF mixed = a;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    mixed.values()[i] = 0.3f * a.values()[i] + 1.2f * b.values()[i];
  }
  const ImageF frame_a = exposed(settings, a);
  const ImageF frame_b = exposed(settings, b);
  const ImageF frame_mixed = exposed(settings, mixed);
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    EXPECT_NEAR(
        frame_mixed.values()[i], 0.3f * frame_a.values()[i] + 1.2f * frame_b.values()[i], 2e-6f);
  }
}

/// Relative spread of the mean over 24 frames of stripes whose period shrinks from 40 to 10 px.
double spread_over_the_scan(double gain) {
  constexpr int kLength = 400;
  constexpr int kFrames = 24;
  const Sensor sensor({.gain = gain, .blur_px = 1.2, .bits = 0}, kLength, 3);
  ScanSums sums;
  ImageF radiance(kLength, 3);
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < kLength; ++x) {
        const double phase = x / 40.0 + 0.5 * x * x * (0.1 - 0.025) / kLength;
        const double shifted = phase + (frame + 0.37) / kFrames;
        radiance(x, y) = shifted - std::floor(shifted) < 0.5 ? 1.0f : 0.0f;
      }
    }
    sensor.accumulate(radiance, frame, sums);
  }
  const ImageF aspect = sums.aspect();
  const auto [low, high] = std::minmax_element(aspect.values().begin(), aspect.values().end());
  return static_cast<double>(*high - *low);
}

// N x duty = 12 bright frames at every pixel: the linear mean is the duty wherever one looks.
TEST(Sensor, ShowsFringeDensityInTheScanMeanOnlyThroughClipping) {
  EXPECT_LT(spread_over_the_scan(1.0), 1e-5);
  EXPECT_GT(spread_over_the_scan(2.0), 0.05);
}

// Pixel 0 is bright in both frames, pixel 1 in one, pixel 2 in none: means 1, (1 + 0.2) / 2 and
// (0.4 + 0) / 2; 0.2 and 0.4 are 51 and 102 of 255.
TEST(Sensor, AccumulatesMeanAndClippedFrames) {
  const Sensor sensor({.gain = 2.0, .blur_px = 0.0}, 3, 1);
  ImageF radiance(3, 1);
  ScanSums sums;
  radiance.values() = {0.5f, 0.9f, 0.2f};
  sensor.accumulate(radiance, 0, sums);
  radiance.values() = {0.8f, 0.1f, 0.0f};
  sensor.accumulate(radiance, 1, sums);
  const ImageF aspect = sums.aspect();
  EXPECT_EQ(aspect(0, 0), 1.0f);
  EXPECT_FLOAT_EQ(aspect(1, 0), 0.6f);
  EXPECT_FLOAT_EQ(aspect(2, 0), 0.2f);
  EXPECT_EQ(sums.clipped_frames.values(), (Image<std::uint16_t>::Values{2, 1, 0}));
}

// What another scan left in the sums does not matter: they hold no frame yet.
TEST(Sensor, StartsSumsOfNoFramesAnew) {
  const Sensor sensor({.gain = 2.0, .blur_px = 0.0, .bits = 0}, 3, 1);
  ImageF radiance(3, 1);
  radiance.values() = {0.25f, 0.5f, 0.125f};
  ScanSums sums(3, 1);
  sums.sum.values() = {7.0, 8.0, 9.0};
  sums.clipped_frames.values() = {7, 8, 9};
  sensor.accumulate(radiance, 0, Spans{{.y = 0, .begin = 0, .end = 2}}, sums);
  EXPECT_EQ(sums.frames, 1);
  EXPECT_EQ(sums.sum.values(), (Image<double>::Values{0.5, 1.0, 9.0}));
  EXPECT_EQ(sums.clipped_frames.values(), (Image<std::uint16_t>::Values{0, 1, 9}));
}

// An even picture's h lives in the last digits of its mean: two grey values that differ by 2^-22
// still do after 99 frames, where a sum in float (99 x 0.7 has steps of 2^-17) would have merged
// them.
TEST(Sensor, KeepsTheLastDigitOfTheMeanOfManyFrames) {
  const Sensor sensor({.gain = 1.0, .blur_px = 0.0, .bits = 0}, 2, 1);
  ImageF radiance(2, 1);
  radiance.values() = {0.7f, 0.7f + 0x1p-22f};
  ScanSums sums;
  for (int frame = 0; frame < 99; ++frame) {
    sensor.accumulate(radiance, frame, sums);
  }
  EXPECT_EQ(sums.aspect(), radiance);
}

TEST(Sensor, AccumulatesTheSameFramesThatItExposes) {
  const Sensor sensor({.gain = 1.5, .full_well_e = 5000.0, .read_noise_e = 4.0}, 61, 23);
  ScanSums sums;
  Image<double> total_of_frames(61, 23);
  for (int frame = 0; frame < 5; ++frame) {
    const ImageF radiance = random_radiance(61, 23, static_cast<std::uint64_t>(frame));
    ImageF alone;
    ImageF kept;
    sensor.expose(radiance, frame, alone);
    sensor.accumulate(radiance, frame, sums, &kept);
    EXPECT_EQ(alone, kept);
    for (std::size_t i = 0; i < alone.size(); ++i) {
      total_of_frames.values()[i] += static_cast<double>(alone.values()[i]);
    }
  }
  EXPECT_EQ(sums.sum, total_of_frames);
  EXPECT_EQ(sums.frames, 5);
}

TEST(Sensor, RefusesAnEmptyImage) {
  EXPECT_THROW(Sensor({}, 0, 10), ConfigError);
}

// 8 bits: (1/255)^2 / 12 = 1.2815e-6; 10 e at 2 / 10000 per electron: 0.002^2 = 4e-6; root of the
// sum 0.0022981.
TEST(NoiseFloor, AddsRoundingAndReadNoiseInSquares) {
  EXPECT_NEAR(
      noise_floor({.gain = 2.0, .full_well_e = 10000.0, .read_noise_e = 10.0}), 0.0022981, 1e-7);
  EXPECT_NEAR(noise_floor({}), 0.0011320, 1e-7);
  EXPECT_EQ(noise_floor({.bits = 0}), 0.0);
}

}  // namespace
}  // namespace glint

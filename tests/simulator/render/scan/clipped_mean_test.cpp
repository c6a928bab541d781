// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan/clipped_mean.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "simulator/render/footprint/stripe_integral.h"

namespace glint {
namespace {

/// A noiseless sensor without rounding.
SensorSettings pure_sensor(double gain, double blur_px = 0.7) {
  return {.gain = gain, .blur_px = blur_px, .bits = 0};
}

/// T(w) by its definition: 4000 phases of the stripe's Fourier series, blurred and clipped.
double mean_by_definition(double gain, double duty, double w) {
  constexpr int kPhases = 4000;
  constexpr int kHarmonics = 80;
  double total = 0.0;
  for (int i = 0; i < kPhases; ++i) {
    const double from_middle = (i + 0.5) / kPhases - 0.5 * duty;
    double share = duty;
    for (int n = 1; n <= kHarmonics; ++n) {
      share += 2.0 / (n * kPi) * std::sin(n * kPi * duty) *
               std::exp(-2.0 * kPi * kPi * n * n * w * w) * std::cos(2.0 * kPi * n * from_middle);
    }
    total += std::min(1.0, gain * share);
  }
  return total / kPhases;
}

// Without blur the wave is 1 on the duty: gain 2, duty 0.5: min(1, 2) / 2. Gain 0.6: 0.3.
// Dark stripes of 0.25 under gain 2: (1 + 0.5) / 2. Blurred away: min(1, gain * mean radiance).
TEST(ClippedMean, BothEndsByHand) {
  const auto at = [](double gain, double duty, double dark, double w) {
    return ClippedMean(pure_sensor(gain), {.duty = duty, .dark = dark}).mean(w);
  };
  EXPECT_NEAR(at(2.0, 0.5, 0.0, 0.0), 0.5, 1e-6);
  EXPECT_NEAR(at(0.6, 0.5, 0.0, 0.0), 0.3, 1e-6);
  EXPECT_NEAR(at(2.0, 0.5, 0.25, 0.0), 0.75, 1e-6);
  EXPECT_NEAR(at(2.0, 0.5, 0.0, 10.0), 1.0, 1e-5);
  EXPECT_NEAR(at(2.0, 0.25, 0.0, 10.0), 0.5, 1e-5);
  EXPECT_NEAR(at(3.0, 0.25, 0.2, 10.0), 1.0, 1e-5);  // 3 (0.2 + 0.8 * 0.25) = 1.2
}

// Narrow edges, gain 2: min(1, 2 Phi(u)) is 2 Phi up to the old edge and 1 from there, so each of
// the two edges gains w times the integral of 2 Phi up to 0, 2 / sqrt(2 pi) = 0.79788:
// T(0.05) = 0.5 + 2 * 0.05 * 0.79788 = 0.57979, slope 1.59577.
TEST(ClippedMean, GrowsLinearlyWithNarrowBlur) {
  const ClippedMean table(pure_sensor(2.0), {});
  EXPECT_NEAR(table.mean(0.05), 0.57979, 2e-4);
  EXPECT_NEAR(table.slope(0.05), 1.59577, 5e-3);
}

TEST(ClippedMean, IsTheMeanOfBlurredAndClippedStripes) {
  for (const double gain : {1.0, 1.5, 2.0, 3.0}) {
    for (const double duty : {0.25, 0.5, 0.7}) {
      const ClippedMean table(pure_sensor(gain), {.duty = duty});
      for (const double w : {0.02, 0.1, 0.17, 0.3, 0.55}) {
        // 96 phases see edges narrower than a few of their steps less exactly.
        EXPECT_NEAR(table.mean(w), mean_by_definition(gain, duty, w), w < 0.05 ? 5e-4 : 2e-4)
            << "gain " << gain << ", duty " << duty << ", w " << w;
      }
    }
  }
}

/// Frames of stripes of a linear phase through the real sensor, box pixels integrated exactly.
double mean_by_sensor(const SensorSettings& settings, double duty, double gx, double gy) {
  constexpr int kSize = 33;
  constexpr int kFrames = 60;
  const Sensor sensor(settings, kSize, kSize);
  ScanSums sums;
  ImageF radiance(kSize, kSize);
  for (int k = 0; k < kFrames; ++k) {
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        StripeSum pixel;
        pixel.add(PixelPolygon(), {.value = gx * x + gy * y, .dx = gx, .dy = gy});
        double share = 0.0;
        pixel.evaluate({static_cast<double>(k) / kFrames}, duty, &share);
        radiance(x, y) = static_cast<float>(share);
      }
    }
    sensor.accumulate(radiance, k, sums);
  }
  return static_cast<double>(sums.sum(kSize / 2, kSize / 2)) / kFrames;
}

// w^2 = (variance of the blur as sampled + 1/12 of the box pixel) |g|^2, along any direction. Box
// and sampled weights are no Gaussian: 0.0011 at gain 3.
TEST(ClippedMean, IsWhatTheSensorMakesOfALinearPhase) {
  for (const double gain : {1.5, 2.0, 3.0}) {
    const SensorSettings settings = pure_sensor(gain, 1.2);
    const ClippedMean table(settings, {.duty = 0.5});
    const double variance = Sensor(settings, 9, 9).blur_variance_px2() + 1.0 / 12.0;
    for (const double size : {0.03, 0.08, 0.15, 0.25}) {
      for (const double angle : {0.0, 0.4, 0.25 * kPi}) {
        const double gx = size * std::cos(angle);
        const double gy = size * std::sin(angle);
        EXPECT_NEAR(
            table.mean(std::sqrt(variance) * size), mean_by_sensor(settings, 0.5, gx, gy), 1.5e-3)
            << "gain " << gain << ", |g| " << size << ", angle " << angle;
      }
    }
  }
}

TEST(ClippedMean, DerivativeIsThatOfTheMean) {
  for (const double gain : {1.3, 2.0, 3.0}) {
    const ClippedMean table(pure_sensor(gain), {.duty = 0.4});
    Rng rng(31, Stream::kTest, static_cast<std::uint64_t>(10 * gain));
    for (int i = 0; i < 1000; ++i) {
      const double w = rng.uniform(0.002, 0.795);
      constexpr double kStep = 1e-3;
      const double difference = (table.mean(w + kStep) - table.mean(w - kStep)) / (2.0 * kStep);
      // Pieces of 0.00625 with continuous slope: the difference averages over a jump of curvature.
      ASSERT_NEAR(table.slope(w), difference, 0.05) << w;
    }
    EXPECT_EQ(table.slope(0.9), 0.0);
  }
}

TEST(ClippedMean, WithoutClippingItDoesNotDependOnTheWidth) {
  const ClippedMean table(pure_sensor(1.0), {.duty = 0.37, .gain = 0.8});
  for (int i = 0; i <= 1000; ++i) {
    const double w = i / 1000.0;
    // Edges narrower than a step of the 96 phases are seen to half a step: 0.8 / 192 = 0.0042.
    ASSERT_NEAR(table.mean(w), 0.8 * 0.37, w < 0.02 ? 0.0042 : 1e-5) << w;
  }
}

// Gain 3: blurred away, duty 0.5 makes 1.5; the darkest place reaches 1/3 when the first harmonic,
// (2 / pi) exp(-2 pi^2 w^2), has fallen to 1/6: w = sqrt(ln(12 / pi) / (2 pi^2)) = 0.26055.
// Gain 1.9 never gets there.
TEST(ClippedMean, IsSaturatedWhereTheDarkestPhaseIsAtFullScale) {
  const ClippedMean saturated(pure_sensor(3.0), {});
  EXPECT_NEAR(saturated.saturated_from(), 0.26055, ClippedMean::kWidest / ClippedMean::kIntervals);
  EXPECT_FALSE(saturated.is_saturated(0.25));
  EXPECT_TRUE(saturated.is_saturated(0.27));
  EXPECT_NEAR(saturated.mean(0.3), 1.0, 1e-6);
  EXPECT_FALSE(ClippedMean(pure_sensor(1.9), {}).is_saturated(100.0));
  EXPECT_TRUE(ClippedMean(pure_sensor(1.0), {.duty = 1.0}).is_saturated(0.0));
}

/// The means of 12,000 pixels of random phase over a scan, exposed by the real sensor.
ImageF means_by_sensor(const SensorSettings& settings, const StripeSettings& stripes, double w) {
  constexpr int kWidth = 120;
  constexpr int kHeight = 100;
  const Sensor sensor(settings, kWidth, kHeight);
  ImageF radiance(kWidth, kHeight);
  ScanSums sums;
  for (int k = 0; k < stripes.frames; ++k) {
    for (std::size_t i = 0; i < radiance.size(); ++i) {
      Rng rng(32, Stream::kTest, i);
      const double phase = rng.uniform() + static_cast<double>(k) / stripes.frames;
      const double share = blurred_stripe(phase, stripes.duty, w);
      radiance.values()[i] =
          static_cast<float>(stripes.gain * (stripes.dark + (1.0 - stripes.dark) * share));
    }
    sensor.accumulate(radiance, k, sums);
  }
  return sums.aspect();
}

struct Scatter {
  double mean = 0.0;
  double all = 0.0;    ///< deviation of the means
  double noise = 0.0;  ///< of it by noise
};

/// Two scans of the same phases and another noise differ by noise alone.
Scatter by_monte_carlo(SensorSettings settings, const StripeSettings& stripes, double w) {
  const ImageF one = means_by_sensor(settings, stripes, w);
  settings.seed += 1;
  const ImageF other = means_by_sensor(settings, stripes, w);
  double sum = 0.0;
  double squares = 0.0;
  double differences = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const auto a = static_cast<double>(one.values()[i]);
    const auto b = static_cast<double>(other.values()[i]);
    sum += 0.5 * (a + b);
    squares += 0.5 * (a * a + b * b);
    differences += 0.5 * (a - b) * (a - b);
  }
  const auto count = static_cast<double>(one.size());
  const double mean = sum / count;
  return {.mean = mean,
          .all = std::sqrt(squares / count - mean * mean),
          .noise = std::sqrt(differences / count)};
}

// 24,000 pixels: the mean is good to deviation / 150, the noise to 1 / sqrt(24000) = 0.65 %. What
// few frames leave beside the noise is not the table's (scan_ripple.h).
TEST(ClippedMean, NoiseIsWhatTheSensorMakes) {
  double ripple = 0.0;
  for (const double gain : {1.0, 1.5, 3.0}) {
    SensorSettings settings = pure_sensor(gain, 0.0);
    settings.full_well_e = 4000.0;
    settings.read_noise_e = 30.0;
    settings.dark_e = 60.0;
    for (const int frames : {6, 24}) {
      const StripeSettings stripes = {.duty = 0.45, .dark = 0.1, .gain = 0.9, .frames = frames};
      const ClippedMean table(settings, stripes);
      for (const double w : {0.05, 0.2, 0.4}) {
        const Scatter found = by_monte_carlo(settings, stripes, w);
        EXPECT_NEAR(table.mean(w), found.mean, 2e-4 + 4.0 * found.all / 110.0)
            << gain << " " << frames << " " << w;
        EXPECT_NEAR(table.deviation(w), found.noise, 0.03 * found.noise + 5e-5)
            << gain << " " << frames << " " << w;
        ripple = std::max(ripple, found.all / found.noise);
      }
    }
  }
  EXPECT_GT(ripple, 2.0);
}

// 400 electrons of 1000, no read noise, gain 2: 0.8 of full scale, deviation 2 / 1000 sqrt(400)
// = 0.04; cut at 1 five deviations away, that is all. Far above full scale nothing is left to vary.
TEST(GreyResponse, FollowsTheElectronsByHand) {
  const SensorSettings sensor = {.gain = 2.0, .full_well_e = 1000.0};
  EXPECT_NEAR(grey_response(sensor, 0.4).mean, 0.8, 1e-6);
  EXPECT_NEAR(std::sqrt(grey_response(sensor, 0.4).variance), 0.04, 1e-5);
  EXPECT_NEAR(grey_response(sensor, 2.0).mean, 1.0, 1e-6);
  EXPECT_NEAR(grey_response(sensor, 2.0).variance, 0.0, 1e-9);
  // At full scale on average half is cut: 1 - s / sqrt(2 pi), s = 0.002 sqrt(500) = 0.04472.
  EXPECT_NEAR(grey_response(sensor, 0.5).mean, 1.0 - 0.04472 / std::sqrt(2.0 * kPi), 1e-5);
}

// Half way up an edge: one half. A quarter period of blur, duty 0.5, in the middle of the bright
// stripe: 1/2 + (2 / pi) exp(-pi^2 / 8) - (2 / (3 pi)) exp(-9 pi^2 / 8) = 0.68538.
TEST(BlurredStripe, FollowsItsFourierSeries) {
  EXPECT_NEAR(blurred_stripe(0.0, 0.5, 0.1), 0.5, 1e-6);
  EXPECT_NEAR(blurred_stripe(0.25, 0.5, 0.25),
              0.5 + 2.0 / kPi * std::exp(-kPi * kPi / 8.0) -
                  2.0 / (3.0 * kPi) * std::exp(-9.0 * kPi * kPi / 8.0),
              1e-8);
  EXPECT_EQ(blurred_stripe(7.2, 0.3, 0.0), 1.0);
  EXPECT_EQ(blurred_stripe(-0.2, 0.3, 0.0), 0.0);
}

}  // namespace
}  // namespace glint

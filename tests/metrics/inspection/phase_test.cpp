// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/phase.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "core/error.h"
#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

/// Frames of one pixel whose brightness is `wave` of the share of the period.
template <class Wave>
std::vector<ImageF> frames_of_pixel(int count, double periods, const Wave& wave) {
  std::vector<ImageF> frames;
  for (int j = 0; j < count; ++j) {
    frames.emplace_back(1, 1, static_cast<float>(wave(periods * j / count)));
  }
  return frames;
}

/// Frames of a picture with a phase for each pixel, mean 0.5.
template <class Phase>
std::vector<ImageF> frames_of(
    int count, int width, int height, double amplitude, const Phase& phase_rad) {
  std::vector<ImageF> frames;
  for (int j = 0; j < count; ++j) {
    ImageF frame(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double turn = 2.0 * kPi * j / count - phase_rad(x, y);
        frame(x, y) = static_cast<float>(0.5 + amplitude * std::cos(turn));
      }
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

double difference_rad(double a, double b) {
  return std::remainder(a - b, 2.0 * kPi);
}

// Four frames: cosine = (I0 - I2) / 2 = 0.3, sine = (I1 - I3) / 2 = 0.4, mean 0.5; amplitude 0.5,
// modulation 1, phase atan2(0.4, 0.3).
TEST(PhaseMaps, MatchAHandWorkedExample) {
  ThreadPool pool(1);
  std::vector<ImageF> frames;
  for (const float grey : {0.8F, 0.9F, 0.2F, 0.1F}) {
    frames.emplace_back(1, 1, grey);
  }
  const PhaseMaps maps = phase_maps(frames, 1.0, pool);
  EXPECT_NEAR(maps.mean(0, 0), 0.5, 1e-6);
  EXPECT_NEAR(maps.modulation(0, 0), 1.0, 1e-6);
  EXPECT_NEAR(maps.phase_rad(0, 0), std::atan2(0.4, 0.3), 1e-6);
}

TEST(PhaseMaps, RecoverMeanModulationAndPhaseForWholeAndBrokenPeriods) {
  ThreadPool pool(1);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Rng rng(1, Stream::kTest, i);
    const int count = 5 + static_cast<int>(rng.uniform(0.0, 40.0));
    const bool is_whole = i % 2 == 0;
    const double periods =
        is_whole ? 1.0 + std::floor(rng.uniform(0.0, 2.0)) : rng.uniform(0.6, 2.2);
    const double mean = rng.uniform(0.3, 0.7);
    const double amplitude = rng.uniform(0.02, 0.3);
    const double phase = rng.uniform(-kPi, kPi);
    const auto frames = frames_of_pixel(count, periods, [&](double turns) {
      return mean + amplitude * std::cos(2.0 * kPi * turns - phase);
    });
    SCOPED_TRACE(::testing::Message() << count << " frames, " << periods << " periods");
    const PhaseMaps maps = phase_maps(frames, periods, pool);
    EXPECT_NEAR(maps.mean(0, 0), mean, 1e-5);
    EXPECT_NEAR(maps.modulation(0, 0), amplitude / mean, 1e-5);
    EXPECT_NEAR(
        difference_rad(static_cast<double>(maps.phase_rad(0, 0)), phase), 0.0, 1e-6 / amplitude);
  }
}

TEST(PhaseMaps, RefuseSequencesThatDoNotHoldAPhase) {
  ThreadPool pool(1);
  const std::vector<ImageF> four(4, ImageF(2, 2, 0.5F));
  EXPECT_THROW(phase_maps({}, 1.0, pool), ConfigError);
  EXPECT_THROW(phase_maps(std::span(four).first(2), 1.0, pool), ConfigError);
  EXPECT_THROW(phase_maps(four, 2.0, pool), ConfigError);   // sines all zero
  EXPECT_THROW(phase_maps(four, 4.0, pool), ConfigError);   // every frame the same
  EXPECT_THROW(phase_maps(four, 0.05, pool), ConfigError);  // a straight line
  EXPECT_THROW(phase_maps(four, 0.0, pool), ConfigError);
  EXPECT_THROW(phase_maps(four, std::numeric_limits<double>::quiet_NaN(), pool), ConfigError);
  EXPECT_NO_THROW(phase_maps(four, 1.0, pool));
  EXPECT_NO_THROW(phase_maps(four, 3.0, pool));

  auto unequal = four;
  unequal[2] = ImageF(3, 2, 0.5F);
  EXPECT_THROW(phase_maps(unequal, 1.0, pool), ConfigError);
  auto broken = four;
  broken[1](1, 1) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(phase_maps(broken, 1.0, pool), ConfigError);
}

// A stripe of N / 2 bright frames of N: its edges pass between the same frames, so the phase takes
// N values and is off by up to half a step, pi / N.
TEST(PhaseMaps, OfSharpStripesAreOffByUpToHalfAStep) {
  ThreadPool pool(1);
  for (const int count : {4, 8, 24}) {
    double worst = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const double phase = 2.0 * kPi * (i + 0.5) / 1000.0;
      const auto frames = frames_of_pixel(count, 1.0, [&](double turns) {
        return std::cos(2.0 * kPi * turns - phase) > 0.0 ? 0.9 : 0.1;
      });
      const double found = static_cast<double>(phase_maps(frames, 1.0, pool).phase_rad(0, 0));
      worst = std::max(worst, std::abs(difference_rad(found, phase)));
    }
    EXPECT_LE(worst, kPi / count + 1e-4);
    EXPECT_GE(worst, 0.95 * kPi / count);
  }
}

// The first harmonic of a square wave of swing 0.8 is 2 / pi * 0.8 = 0.509 over its mean 0.5.
TEST(PhaseMaps, ModulationOfSharpStripesIsThatOfTheirFirstHarmonic) {
  ThreadPool pool(1);
  const auto frames =
      frames_of_pixel(1000, 1.0, [](double turns) { return turns < 0.5 ? 0.9 : 0.1; });
  EXPECT_NEAR(phase_maps(frames, 1.0, pool).modulation(0, 0), 2.0 / kPi * 0.8 / 0.5, 1e-3);
}

/// The standard deviation of a phase by the normal matrix' inverse, for the worst mixture of cosine
/// and sine.
double phase_noise_rad(int frames, double periods, double grey_noise, double amplitude) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  for (int j = 0; j < frames; ++j) {
    const double angle = 2.0 * kPi * periods * j / frames;
    const Eigen::Vector3d wave(1.0, std::cos(angle), std::sin(angle));
    normal += wave * wave.transpose();
  }
  const Eigen::Matrix2d covariance = normal.inverse().bottomRightCorner<2, 2>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> spread(covariance);
  return std::sqrt(spread.eigenvalues()(1)) * grey_noise / amplitude;
}

TEST(PhaseNoise, IsWhatNoisyFramesShow) {
  ThreadPool pool(1);
  constexpr int kPixels = 100;
  for (const int count : {3, 8, 24}) {
    auto frames = frames_of(
        count, kPixels, kPixels, 0.3, [](int x, int y) { return 0.001 * (x + kPixels * y); });
    const auto exact = phase_maps(frames, 1.0, pool).phase_rad;
    Rng rng(2, Stream::kTest, static_cast<std::uint64_t>(count));
    for (ImageF& frame : frames) {
      for (float& grey : frame.values()) {
        grey += static_cast<float>(0.01 * rng.normal());
      }
    }
    const auto noisy = phase_maps(frames, 1.0, pool).phase_rad;
    double squares = 0.0;
    for (std::size_t i = 0; i < noisy.size(); ++i) {
      const double d = difference_rad(static_cast<double>(noisy.values()[i]),
                                      static_cast<double>(exact.values()[i]));
      squares += d * d;
    }
    const double found = std::sqrt(squares / (kPixels * kPixels));
    const double expected = std::sqrt(2.0 / count) * 0.01 / 0.3;
    EXPECT_NEAR(found, expected, 0.03 * expected);  // four standard errors of 10,000 pixels
  }
}

TEST(PhaseNoise, IsThatOfTheWorstPhaseForBrokenPeriods) {
  ThreadPool pool(1);
  constexpr int kTimes = 4000;
  constexpr int kFrames = 12;
  double worst = 0.0;
  for (int k = 0; k < 24; ++k) {
    const double phase = kPi * k / 24.0;
    std::vector<ImageF> frames;
    Rng rng(3, Stream::kTest, static_cast<std::uint64_t>(k));
    for (int j = 0; j < kFrames; ++j) {
      ImageF frame(kTimes, 1);
      for (float& grey : frame.values()) {
        grey = static_cast<float>(0.5 + 0.3 * std::cos(2.0 * kPi * 0.6 * j / kFrames - phase) +
                                  0.005 * rng.normal());
      }
      frames.push_back(std::move(frame));
    }
    double squares = 0.0;
    const ImageF phases = phase_maps(frames, 0.6, pool).phase_rad;
    for (const float found : phases.values()) {
      squares += std::pow(difference_rad(static_cast<double>(found), phase), 2);
    }
    worst = std::max(worst, std::sqrt(squares / kTimes));
  }
  const double expected = phase_noise_rad(kFrames, 0.6, 0.005, 0.3);
  EXPECT_NEAR(worst, expected, 0.06 * expected);
  EXPECT_GT(expected, 1.3 * std::sqrt(2.0 / kFrames) * 0.005 / 0.3);
}

// Half the size of the kernel off the border the window is whole, and a plane has its mean in the
// middle, however often its phase wraps.
TEST(PhaseResponse, OfAnEvenlyGrowingPhaseIsZeroAwayFromTheRim) {
  ThreadPool pool(2);
  const auto frames =
      frames_of(12, 60, 40, 0.3, [](int x, int y) { return 0.35 * x - 0.2 * y + 2.0; });
  const ImageF response = phase_response(frames, 1.0, Mask(60, 40, 1), 9, 0.0, pool);
  for (int y = 4; y < 36; ++y) {
    for (int x = 4; x < 56; ++x) {
      ASSERT_NEAR(response(x, y), 0.0, 2e-5) << x << ", " << y;
    }
  }
  EXPECT_GT(std::abs(response(0, 20)), 0.01F);  // at the rim the window is lopsided
}

// A dent whose phase is small against one adds phase minus its Gaussian mean (to 3 %: phasors far
// off on the slope count a little less).
TEST(PhaseResponse, OfADentIsItsPhaseMinusItsLocalMean) {
  ThreadPool pool(2);
  const auto dent = [](int x, int y) {
    return 0.1 * std::exp(-((x - 30) * (x - 30) + (y - 20) * (y - 20)) / 8.0);
  };
  const auto frames =
      frames_of(12, 60, 40, 0.3, [&](int x, int y) { return 0.15 * x + dent(x, y); });
  const ImageF response = phase_response(frames, 1.0, Mask(60, 40, 1), 9, 1.7, pool);
  double mean = 0.0;
  double weight = 0.0;
  for (int v = -4; v <= 4; ++v) {
    for (int u = -4; u <= 4; ++u) {
      const double w = std::exp(-(u * u + v * v) / (2.0 * 1.7 * 1.7));
      mean += w * dent(30 + u, 20 + v);
      weight += w;
    }
  }
  EXPECT_NEAR(response(30, 20), (0.1 - mean / weight) / (2.0 * kPi), 2e-4);
}

TEST(PhaseResponse, DoesNotSeeWhatIsOutsideTheMaskAndIsZeroThere) {
  ThreadPool pool(2);
  const auto phase = [](int x, int y) { return 0.1 * x + 0.02 * std::sin(0.9 * x * y); };
  auto frames = frames_of(6, 40, 30, 0.3, phase);
  Mask mask(40, 30);
  for (int y = 5; y < 25; ++y) {
    for (int x = 7; x < 33; ++x) {
      mask(x, y) = 1;
    }
  }
  const ImageF before = phase_response(frames, 1.0, mask, 9, 0.0, pool);
  Rng rng(4, Stream::kTest, 0);
  for (ImageF& frame : frames) {
    for (std::size_t i = 0; i < frame.size(); ++i) {
      if (mask.values()[i] == 0) {
        frame.values()[i] = static_cast<float>(rng.uniform());
      }
    }
  }
  EXPECT_EQ(phase_response(frames, 1.0, mask, 9, 0.0, pool), before);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    EXPECT_TRUE(mask.values()[i] != 0 || before.values()[i] == 0.0F);
  }
  EXPECT_NE(before(20, 15), 0.0F);
}

TEST(PhaseResponse, IsZeroWhereNoStripeIsSeen) {
  ThreadPool pool(1);
  Rng rng(5, Stream::kTest, 0);
  std::vector<ImageF> frames;
  for (int j = 0; j < 24; ++j) {
    ImageF frame(30, 30);
    for (float& grey : frame.values()) {
      grey = static_cast<float>(0.005 * rng.normal());  // amplitude noise 0.0014
    }
    frames.push_back(std::move(frame));
  }
  EXPECT_EQ(phase_response(frames, 1.0, Mask(30, 30, 1), 9, 0.0, pool), ImageF(30, 30));
}

TEST(PhaseResponse, HasTheSameBytesForAnyNumberOfThreads) {
  ThreadPool one(1);
  ThreadPool four(4);
  const auto frames =
      frames_of(7, 131, 77, 0.2, [](int x, int y) { return 0.2 * x + std::sin(0.1 * x * y); });
  const Mask mask(131, 77, 1);
  EXPECT_EQ(phase_response(frames, 1.0, mask, 15, 0.0, one),
            phase_response(frames, 1.0, mask, 15, 0.0, four));
}

}  // namespace
}  // namespace glint

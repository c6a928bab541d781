// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/inspector.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/error.h"
#include "core/rng.h"
#include "core/units.h"
#include "metrics/inspection/aspect.h"
#include "metrics/inspection/calibration.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Filter = InspectionSettings::Filter;
using Threshold = InspectionSettings::Threshold;

/// A ragged part with a hole in it.
Mask ragged_part(int width_px, int height_px) {
  Mask mask(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const double u = 2.0 * (x + 0.5) / width_px - 1.0;
      const double v = 2.0 * (y + 0.5) / height_px - 1.0;
      const double radius = std::hypot(u, v);
      const double rim = 0.9 + 0.08 * std::sin(9.0 * std::atan2(v, u));
      mask(x, y) = radius < rim && radius > 0.15 ? 1 : 0;
    }
  }
  return mask;
}

std::vector<InspectionSettings> linear_filters(int erosion_px) {
  InspectionSettings gaussian{.erosion_px = erosion_px};
  InspectionSettings wide = gaussian;
  wide.kernel_px = 41;
  wide.sigma_px = 9.0;
  InspectionSettings differences = gaussian;
  differences.filter = Filter::kDifferenceOfGaussians;
  InspectionSettings matched = gaussian;
  matched.filter = Filter::kMatched;
  InspectionSettings large = differences;
  large.scales_px = {0.5, 20.0};
  return {gaussian, wide, differences, large, matched};
}

TEST(InspectorResponse, IsZeroForConstantImagesAlsoAtTheRim) {
  ThreadPool pool(2);
  const Mask mask = ragged_part(140, 90);
  for (const InspectionSettings& settings : linear_filters(0)) {
    const Inspector inspector(settings, mask);
    EXPECT_EQ(inspector.region(), mask) << "no rim was asked for";
    for (const float grey : {0.0F, 0.37F, 1.0F}) {
      ImageF aspect(140, 90, 0.8F);  // what is outside must not count
      for (std::size_t i = 0; i < aspect.size(); ++i) {
        aspect.values()[i] = mask.values()[i] != 0 ? grey : 0.8F;
      }
      const ImageF response = inspector.response(aspect, pool);
      for (const float value : response.values()) {
        ASSERT_LE(static_cast<double>(std::abs(value)),
                  inspector.min_threshold() * static_cast<double>(grey))
            << "filter " << static_cast<int>(settings.filter);
      }
    }
  }
}

// A spot of height 1 and diameter 5 px (sigma 1.25) on any background is answered by its height.
TEST(InspectorResponse, OfTheMatchedFilterIsTheHeightOfItsSpot) {
  ThreadPool pool(1);
  const Inspector inspector({.filter = Filter::kMatched, .erosion_px = 0}, ragged_part(140, 90));
  ImageF aspect(140, 90);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 140; ++x) {
      const double square = (x - 35.0) * (x - 35.0) + (y - 40.0) * (y - 40.0);
      aspect(x, y) = static_cast<float>(0.3 + 0.25 * std::exp(-0.5 * square / (1.25 * 1.25)));
    }
  }
  EXPECT_NEAR(inspector.response(aspect, pool)(35, 40), 0.25F, 1e-5F);
}

// Spot 1 and e = exp(-0.5 / 1.25^2) on two pixels, times 0.25 on 0.3: two unknowns, two values.
TEST(InspectorResponse, OfTheMatchedFilterIsTheHeightOnAMaskOfTwoPixels) {
  ThreadPool pool(1);
  Mask mask(9, 5);
  mask(4, 2) = 1;
  mask(5, 2) = 1;
  ImageF aspect(9, 5, 0.7F);
  aspect(4, 2) = 0.3F + 0.25F;
  aspect(5, 2) = static_cast<float>(0.3 + 0.25 * std::exp(-0.5 / (1.25 * 1.25)));
  const Inspector inspector({.filter = Filter::kMatched, .erosion_px = 0}, mask);
  EXPECT_NEAR(inspector.response(aspect, pool)(4, 2), 0.25F, 1e-4F);
}

/// Taps of a Gaussian of sum 1 at -reach to reach.
std::vector<double> taps_of(double sigma_px, int reach) {
  std::vector<double> taps;
  for (int k = -reach; k <= reach; ++k) {
    taps.push_back(std::exp(-0.5 * k * k / (sigma_px * sigma_px)));
  }
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  std::ranges::for_each(taps, [sum](double& tap) { tap /= sum; });
  return taps;
}

// Gaussians of 2 and 3.2 px, cut at three sigma, 6 and 10 px; a pixel of 1 is answered by their
// difference in the middle over the root of the sum of its squares.
TEST(InspectorResponse, OfDifferencesOfGaussiansIsThatOf1Point6Times) {
  ThreadPool pool(1);
  const std::vector<double> narrow = taps_of(2.0, 6);
  const std::vector<double> wide = taps_of(3.2, 10);
  const auto tap_at = [](const std::vector<double>& taps, int reach, int k) {
    return std::abs(k) <= reach ? taps[static_cast<std::size_t>(k + reach)] : 0.0;
  };
  double squares = 0.0;
  for (int y = -10; y <= 10; ++y) {
    for (int x = -10; x <= 10; ++x) {
      const double difference =
          tap_at(narrow, 6, x) * tap_at(narrow, 6, y) - tap_at(wide, 10, x) * tap_at(wide, 10, y);
      squares += difference * difference;
    }
  }
  ImageF aspect(41, 41);
  aspect(20, 20) = 1.0F;
  const Inspector inspector(
      {.filter = Filter::kDifferenceOfGaussians, .scales_px = {2.0}, .erosion_px = 0},
      Mask(41, 41, 1));
  const double expected = (narrow[6] * narrow[6] - wide[10] * wide[10]) / std::sqrt(squares);
  EXPECT_NEAR(static_cast<double>(inspector.response(aspect, pool)(20, 20)), expected, 1e-5);
}

TEST(InspectorResponse, OfDifferencesOfGaussiansKeepsTheNoiseOfEachScale) {
  ThreadPool pool(2);
  ImageF noise(400, 300);
  Rng rng(41, Stream::kTest, 0);
  std::ranges::generate(noise.values(), [&] { return static_cast<float>(0.01 * rng.normal()); });
  for (const double scale_px : {0.7, 1.0, 2.0}) {
    const Inspector inspector(
        {.filter = Filter::kDifferenceOfGaussians, .scales_px = {scale_px}, .erosion_px = 12},
        Mask(400, 300, 1));
    EXPECT_NEAR(inspector.noise(inspector.response(noise, pool), pool), 0.01, 4e-4) << scale_px;
  }
}

TEST(Inspector, TakesTheRimOffAndTheBorderOfThePicture) {
  const Inspector inspector({.erosion_px = 3}, Mask(10, 9, 1));
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 10; ++x) {
      const bool is_inner = x >= 3 && x < 7 && y >= 3 && y < 6;
      EXPECT_EQ(inspector.region()(x, y), is_inner ? 1 : 0) << x << ", " << y;
    }
  }
}

TEST(Inspector, RefusesMasksOfWhichNothingIsLeft) {
  EXPECT_THAT([] { const Inspector inspector({.erosion_px = 4}, Mask(8, 100, 1)); },
              ThrowsMessage<ConfigError>(HasSubstr("inspection.erosion_px")));
  EXPECT_THAT([] { const Inspector inspector({.erosion_px = 4}, Mask(20, 20, 0)); },
              ThrowsMessage<ConfigError>(HasSubstr("the mask has no pixel")));
}

TEST(Inspector, RefusesPicturesThatDoNotFitAndNaN) {
  ThreadPool pool(2);
  const Inspector inspector({}, Mask(50, 40, 1));
  EXPECT_THAT([&] { inspector.inspect(ImageF(40, 50), pool); },
              ThrowsMessage<ConfigError>(HasSubstr("40 x 50 px")));
  const std::vector<Image<std::uint8_t>> frames(3, Image<std::uint8_t>(49, 40));
  EXPECT_THAT([&] { inspector.inspect(frames, pool); },
              ThrowsMessage<ConfigError>(HasSubstr("49 x 40 px")));
  ImageF aspect(50, 40, 0.5F);
  aspect(13, 37) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { inspector.inspect(aspect, pool); },
              ThrowsMessage<ConfigError>(HasSubstr("pixel (13, 37)")));
  aspect(13, 37) = 3e38F;  // a number, but sums of such are none
  EXPECT_THAT([&] { inspector.inspect(aspect, pool); },
              ThrowsMessage<ConfigError>(HasSubstr("beyond 1e+20, must be a share of full scale")));
  const Inspector phase({.filter = Filter::kPhase}, Mask(50, 40, 1));
  EXPECT_THAT([&] { phase.response(ImageF(50, 40), pool); },
              ThrowsMessage<ConfigError>(HasSubstr("inspection.filter: phase needs the images")));
  const Inspector alarms({.threshold = Threshold::kFalseAlarms}, Mask(50, 40, 1));
  EXPECT_THAT([&] { alarms.inspect(ImageF(50, 40), pool); },
              ThrowsMessage<ConfigError>(HasSubstr("inspection.threshold: false_alarms needs")));
}

TEST(Inspector, FindsNothingInBlackOrSaturatedSequences) {
  ThreadPool pool(2);
  for (const InspectionSettings& settings : linear_filters(4)) {
    const Inspector inspector(settings, ragged_part(140, 90));
    for (const int code : {0, 255}) {
      const std::vector<Image<std::uint8_t>> frames(
          24, Image<std::uint8_t>(140, 90, static_cast<std::uint8_t>(code)));
      const Inspection result = inspector.inspect(frames, pool);
      EXPECT_TRUE(result.defects.empty());
      EXPECT_GE(result.threshold, kMinThreshold);
      EXPECT_TRUE(inspector
                      .blobs(inspector.response(aspect_of(frames, pool), pool),
                             inspector.min_threshold(),
                             pool)
                      .empty())
          << "rounding beyond the least threshold";
    }
  }
}

std::vector<Image<std::uint8_t>> noisy_sequence(int frames, int width_px, int height_px) {
  std::vector<Image<std::uint8_t>> sequence;
  for (int j = 0; j < frames; ++j) {
    Image<std::uint8_t> frame(width_px, height_px);
    Rng rng(42, Stream::kTest, static_cast<std::uint64_t>(j));
    for (int y = 0; y < height_px; ++y) {
      for (int x = 0; x < width_px; ++x) {
        const double phase = x / 26.0 + static_cast<double>(j) / frames;
        const double spot = std::pow(std::cos(0.11 * x) * std::cos(0.13 * y), 12.0);
        const double grey = (phase - std::floor(phase) < 0.5 ? 150.0 : 40.0) + 60.0 * spot;
        frame(x, y) = static_cast<std::uint8_t>(std::clamp(grey + 2.0 * rng.normal(), 0.0, 255.0));
      }
    }
    sequence.push_back(std::move(frame));
  }
  return sequence;
}

std::vector<double> numbers_of(const Inspection& inspection) {
  std::vector<double> numbers = {inspection.threshold, inspection.noise};
  for (const FoundDefect& defect : inspection.defects) {
    for (const double value : {defect.x_px,
                               defect.y_px,
                               defect.weight,
                               defect.peak,
                               defect.length_px,
                               defect.width_px,
                               defect.angle_rad,
                               static_cast<double>(defect.area_px),
                               static_cast<double>(defect.left_px)}) {
      numbers.push_back(value);
    }
  }
  return numbers;
}

struct AllSteps {
  ImageF aspect;
  ImageF response;
  std::vector<double> list;
  std::vector<double> list_of_aspect;

  bool operator==(const AllSteps&) const = default;
};

/// One pool at a time: a small one would limit the others.
AllSteps all_steps(const Inspector& inspector,
                   const std::vector<Image<std::uint8_t>>& frames,
                   int threads) {
  ThreadPool pool(threads);
  AllSteps steps{.aspect = aspect_of(frames, pool)};
  steps.response = inspector.response(steps.aspect, pool);
  steps.list = numbers_of(inspector.inspect(frames, pool));
  steps.list_of_aspect = numbers_of(inspector.inspect(steps.aspect, pool));
  return steps;
}

TEST(Inspector, GivesTheSameBytesForAnyNumberOfThreads) {
  const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 7);
  const auto frames = noisy_sequence(9, 211, 133);
  for (InspectionSettings settings : linear_filters(2)) {
    settings.threshold_sigmas = 2.0;
    const Inspector inspector(settings, ragged_part(211, 133));
    const AllSteps alone = all_steps(inspector, frames, 1);
    EXPECT_GT(alone.list.size(), 40U) << "too few defects to compare";
    EXPECT_EQ(alone.list, alone.list_of_aspect);
    for (const int threads : {2, 7, 7, 7}) {
      EXPECT_TRUE(all_steps(inspector, frames, threads) == alone) << threads << " threads";
    }
  }
}

// A pool within would set oneTBB's limit for the whole program to the machine's threads.
TEST(InspectorThreshold, DoesNotLimitTheThreadsOfTheProgram) {
  constexpr auto kLimit = tbb::global_control::max_allowed_parallelism;
  const auto many = static_cast<std::size_t>(hardware_threads() + 5);
  const tbb::global_control wide(kLimit, many);
  ASSERT_EQ(tbb::global_control::active_value(kLimit), many);
  const Inspector inspector({}, Mask(300, 200, 1));
  const ImageF response(300, 200, 0.5F);
  std::atomic<bool> is_done = false;
  std::size_t minimum = many;
  std::thread watcher([&] {
    while (!is_done) {
      minimum = std::min(minimum, tbb::global_control::active_value(kLimit));
    }
  });
  for (int i = 0; i < 300; ++i) {
    EXPECT_EQ(inspector.threshold(response), kMinThreshold);
  }
  is_done = true;
  watcher.join();
  EXPECT_EQ(minimum, many);
}

TEST(InspectorThreshold, IsThatOfAnInspection) {
  ThreadPool pool(2);
  const auto frames = noisy_sequence(9, 211, 133);
  for (InspectionSettings settings : linear_filters(2)) {
    const Inspector by_noise(settings, ragged_part(211, 133));
    const ImageF response = by_noise.response(aspect_of(frames, pool), pool);
    const Inspection inspection = by_noise.inspect(frames, pool);
    EXPECT_GT(inspection.noise, 0.0);
    EXPECT_EQ(inspection.noise, by_noise.noise(response, pool));
    EXPECT_EQ(inspection.threshold, 6.0 * inspection.noise) << "threshold_sigmas";
    EXPECT_EQ(inspection.threshold, by_noise.threshold(response));
    settings.threshold = Threshold::kFixed;
    settings.threshold_grey = 0.04;
    const Inspector fixed(settings, ragged_part(211, 133));
    EXPECT_EQ(fixed.threshold(response), 0.04);
    EXPECT_EQ(fixed.inspect(frames, pool).threshold, 0.04);
    EXPECT_EQ(fixed.inspect(frames, pool).noise, 0.0) << "not asked for";
  }
}

TEST(Inspector, InspectsPhasesOfASequence) {
  ThreadPool pool(2);
  std::vector<ImageF> frames;
  for (int j = 0; j < 8; ++j) {
    ImageF frame(120, 80);
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 120; ++x) {
        const double square = (x - 60.0) * (x - 60.0) + (y - 40.0) * (y - 40.0);
        const double dent = 0.8 * std::exp(-0.5 * square / 4.0);
        const double phase = 2.0 * kPi * j / 8.0 - 0.2 * x - dent;
        frame(x, y) = static_cast<float>(0.5 + 0.3 * std::cos(phase));
      }
    }
    frames.push_back(std::move(frame));
  }
  const Inspector inspector({.filter = Filter::kPhase,
                             .threshold = Threshold::kFixed,
                             .threshold_grey = 0.03,
                             .erosion_px = 6},
                            Mask(120, 80, 1));
  const Inspection result = inspector.inspect(frames, pool);
  const auto nearest = std::ranges::min_element(result.defects, {}, [](const FoundDefect& found) {
    return std::hypot(found.x_px - 60.5, found.y_px - 40.5);
  });
  ASSERT_NE(nearest, result.defects.end());
  EXPECT_LT(std::hypot(nearest->x_px - 60.5, nearest->y_px - 40.5), 0.6);
}

std::vector<ImageF> noise_responses(const Inspector& inspector, int count) {
  ThreadPool pool(1);
  std::vector<ImageF> responses;
  for (int i = 0; i < count; ++i) {
    ImageF aspect(120, 80);
    Rng rng(43, Stream::kTest, static_cast<std::uint64_t>(i));
    std::ranges::generate(aspect.values(),
                          [&] { return static_cast<float>(0.5 + 0.01 * rng.normal()); });
    responses.push_back(inspector.response(aspect, pool));
  }
  return responses;
}

int blobs_at(const Inspector& inspector, const std::vector<ImageF>& responses, double threshold) {
  ThreadPool pool(1);
  return std::accumulate(responses.begin(), responses.end(), 0, [&](int sum, const ImageF& image) {
    return sum + static_cast<int>(inspector.blobs(image, threshold, pool).size());
  });
}

TEST(ThresholdFor, IsTheSmallestThatKeepsTheFalseAlarms) {
  ThreadPool pool(2);
  for (const int min_area_px : {1, 2}) {
    const Inspector inspector({.min_area_px = min_area_px}, ragged_part(120, 80));
    const std::vector<ImageF> responses = noise_responses(inspector, 30);
    for (const double rate : {0.01, 0.1, 1.0, 5.0}) {
      SCOPED_TRACE(::testing::Message() << rate << " a picture, " << min_area_px << " px");
      const double threshold = threshold_for(inspector, responses, rate, pool);
      const int allowed = static_cast<int>(rate * 30.0 + 1e-9);
      EXPECT_LE(blobs_at(inspector, responses, threshold), allowed);
      const float below = std::nextafter(static_cast<float>(threshold), 0.0F);
      EXPECT_GT(blobs_at(inspector, responses, static_cast<double>(below)), allowed);
      double higher = threshold;
      while (higher < 0.1) {
        ASSERT_LE(blobs_at(inspector, responses, higher), allowed) << "at " << higher;
        higher *= 1.003;
      }
    }
  }
}

TEST(ThresholdFor, RefusesNoPicturesAndAcceptsFlatOnes) {
  ThreadPool pool(1);
  const Inspector inspector({}, Mask(50, 40, 1));
  EXPECT_THROW(threshold_for(inspector, {}, 0.1, pool), ConfigError);
  const std::vector<ImageF> flat(3, ImageF(50, 40));
  EXPECT_EQ(threshold_for(inspector, flat, 0.1, pool), kMinThreshold);
}

}  // namespace
}  // namespace glint

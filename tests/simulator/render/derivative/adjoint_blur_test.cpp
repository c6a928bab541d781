// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/derivative/adjoint_blur.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "core/image/spans.h"
#include "core/rng.h"
#include "simulator/render/derivative/blur_derivative.h"

namespace glint {
namespace {

ImageF random_image(std::uint64_t seed, int width, int height) {
  Rng rng(seed, Stream::kTest, 0);
  ImageF image(width, height);
  for (float& value : image.values()) {
    value = static_cast<float>(rng.uniform());
  }
  return image;
}

double product_of(const ImageF& a, const ImageF& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += static_cast<double>(a.values()[i]) * static_cast<double>(b.values()[i]);
  }
  return sum;
}

Sensor blur_of(double sigma_px, int width, int height) {
  return {{.exposure = 1.0, .gain = 1.0, .blur_px = sigma_px, .bits = 0}, width, height};
}

/// In spans of 5 pixels, so that most of them begin and end inside the image.
ImageF backwards(const Sensor& sensor, const ImageF& by_blurred) {
  const int width = by_blurred.width();
  AdjointBlur blur(sensor, width, by_blurred.height());
  ImageF gradient(width, by_blurred.height());
  for (int y = 0; y < by_blurred.height(); ++y) {
    for (int begin = 0; begin < width; begin += 5) {
      const int end = std::min(width, begin + 5);
      blur.apply(by_blurred, {.y = y, .begin = begin, .end = end}, gradient.row(y) + begin);
    }
  }
  return gradient;
}

// (blur x) . y = x . (blur backwards y) for any x and y: borders stand for what lies beyond.
TEST(AdjointBlur, IsTheTransposeOfTheBlur) {
  for (const auto& [width, height] : {std::pair(31, 23), std::pair(9, 1), std::pair(1, 7)}) {
    for (const double sigma_px : {0.0, 0.6, 1.3}) {
      const Sensor sensor = blur_of(sigma_px, width, height);
      const ImageF radiance = random_image(1, width, height);
      const ImageF by_blurred = random_image(2, width, height);
      ImageF blurred;
      sensor.expose(radiance, 0, blurred);
      const double forwards = product_of(blurred, by_blurred);
      EXPECT_NEAR(product_of(radiance, backwards(sensor, by_blurred)), forwards, 3e-6 * forwards)
          << width << " x " << height << ", " << sigma_px;
    }
  }
}

TEST(AdjointBlur, TheCornerCollectsWhatLiesBeyondIt) {
  const Sensor sensor = blur_of(1.0, 12, 12);
  ImageF by_blurred(12, 12);
  by_blurred(0, 0) = 1.0F;
  const float centre = sensor.blur_weights()[0];
  const float to_corner = 0.5F + 0.5F * centre;  // along each axis
  EXPECT_NEAR(backwards(sensor, by_blurred)(0, 0), to_corner * to_corner, 1e-6);
}

/// Derivative by the blur of the sum of by * blurred over the whole image.
double change_of(const ImageF& radiance, const ImageF& by, double sigma_px) {
  const Sensor sensor = blur_of(sigma_px, by.width(), by.height());
  const Spans all = whole_image(by.width(), by.height());
  return BlurDerivative(sensor, all, all).derivative(radiance, by);
}

// d/ds of the mean of cos(a x) is -s a^2 times itself, the blur a (cut off) Gaussian of sigma s.
TEST(BlurDerivative, IsThatOfAWave) {
  constexpr double kPerPixel = 0.35;
  constexpr int kSize = 101;
  for (const double sigma_px : {0.3, 0.55, 0.7, 0.85, 1.3, 2.5}) {
    ImageF wave(kSize, kSize), by(kSize, kSize);
    double expected = 0.0;
    for (int y = 15; y < kSize - 15; ++y) {
      by(kSize / 2, y) = 1.0F;
    }
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const double angle = kPerPixel * (0.6 * x + 0.8 * y);
        wave(x, y) = static_cast<float>(0.5 + 0.4 * std::cos(angle));
        expected -= 0.4 * static_cast<double>(by(x, y)) * sigma_px * kPerPixel * kPerPixel *
                    std::exp(-0.5 * std::pow(sigma_px * kPerPixel, 2)) * std::cos(angle);
      }
    }
    EXPECT_GT(std::abs(expected), 0.01);
    EXPECT_NEAR(change_of(wave, by, sigma_px), expected, 6e-3 * std::abs(expected)) << sigma_px;
  }
}

// By the difference of two blurs; nothing is cut off, the picture is bright everywhere.
TEST(BlurDerivative, IsTheDifferenceOfTwoBlurs) {
  constexpr double kStep = 5e-3;
  Rng rng(71, Stream::kTest, 0);
  ImageF radiance = random_image(5, 40, 30);
  for (float& value : radiance.values()) {
    value = 0.4F + 0.5F * value;
  }
  const ImageF by = random_image(6, 40, 30);
  for (int i = 0; i < 30; ++i) {
    const double sigma_px = rng.uniform(0.05, 1.6);
    const Sensor high = blur_of(sigma_px + kStep, 40, 30);
    const Sensor low = blur_of(sigma_px - kStep, 40, 30);
    if (high.blur_radius_px() != low.blur_radius_px()) {
      continue;
    }
    ImageF more, less;
    high.expose(radiance, 0, more);
    low.expose(radiance, 0, less);
    const double expected = (product_of(more, by) - product_of(less, by)) / (2.0 * kStep);
    EXPECT_NEAR(change_of(radiance, by, sigma_px), expected, 2e-3 * std::abs(expected) + 0.01)
        << sigma_px;
  }
}

TEST(BlurDerivative, AnEvenPictureHasNone) {
  const ImageF even(40, 30, 0.7F);
  EXPECT_NEAR(change_of(even, random_image(3, 40, 30), 1.3) / (40 * 30), 0.0, 1e-6);
}

}  // namespace
}  // namespace glint

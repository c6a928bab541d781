// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/aspect_image/noise_variance.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

constexpr int kNoiseSide = 64;

/// A normal number by Box and Muller.
double normal_number(Rng& rng) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - rng.uniform()));
  return radius * std::cos(2.0 * kPi * rng.uniform());
}

Homogeneity score_of(const ImageF& image, const Mask& region) {
  return homogeneity(image, {}, 24, region);
}

// Two pixels 0.4 and 0.6: mean 0.5, deviation 0.1, h_rms 0.8. Scatter of 0.24 on both adds in
// squares: sqrt(0.01 + 0.0576) = 0.26, h_rms = 0.48.
TEST(WithNoiseVariance, DeviationsAddInSquares) {
  ImageF aspect(2, 1);
  aspect(0, 0) = 0.4F;
  aspect(1, 0) = 0.6F;
  const Mask region(2, 1, 1);
  const Homogeneity scattered =
      with_noise_variance(score_of(aspect, region), aspect, ImageF(2, 1, 0.24F), region);
  EXPECT_NEAR(scattered.h_rms, 0.48, 1e-6);
}

// An even image: mean |f - mu| is that of a normal number, 0.1 sqrt(2 / pi) = 0.0797885; over 0.5.
TEST(WithNoiseVariance, AnEvenImageHasTheNormalNumbersMeanSize) {
  const Mask region(4, 4, 1);
  const ImageF aspect(4, 4, 0.5F);
  const Homogeneity scattered =
      with_noise_variance(score_of(aspect, region), aspect, ImageF(4, 4, 0.1F), region);
  EXPECT_NEAR(scattered.h_abs, 1.0 - 0.159577, 1e-6);
  EXPECT_NEAR(scattered.h_rms, 0.8, 1e-6);
}

TEST(WithNoiseVariance, NoNoiseChangesNothing) {
  const Mask region(4, 4, 1);
  ImageF aspect(4, 4, 0.5F);
  aspect(1, 1) = 0.7F;
  const Homogeneity plain = score_of(aspect, region);
  const Homogeneity same = with_noise_variance(plain, aspect, ImageF(4, 4), region);
  EXPECT_DOUBLE_EQ(same.h_abs, plain.h_abs);
  EXPECT_NEAR(same.h_rms, plain.h_rms, 1e-12);
}

TEST(WithNoiseVariance, PixelsOutsideTheRegionDoNotCount) {
  Mask region(4, 4, 1);
  region(0, 0) = 0;
  ImageF deviation(4, 4);
  deviation(0, 0) = 0.3F;
  const ImageF aspect(4, 4, 0.5F);
  EXPECT_NEAR(
      with_noise_variance(score_of(aspect, region), aspect, deviation, region).h_rms, 1.0, 1e-12);
}

// One pixel at a time beside one at rest: the mean of |x| for a normal number of mean m and
// deviation d is d sqrt(2 / pi) exp(-m^2 / 2 d^2) + m erf(m / (d sqrt 2)).
TEST(WithNoiseVariance, TheMeanSizeIsThatOfANormalNumber) {
  const Mask region(2, 1, 1);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Rng rng(102, Stream::kTest, i);
    ImageF aspect(2, 1, 0.5F);
    ImageF deviation(2, 1);
    aspect(0, 0) += static_cast<float>(rng.uniform(-0.4, 0.4));
    deviation(0, 0) = static_cast<float>(rng.uniform(1e-3, 0.3));
    const Homogeneity plain = score_of(aspect, region);
    const auto d = static_cast<double>(deviation(0, 0));
    const double m = std::abs(static_cast<double>(aspect(0, 0)) - plain.mean);
    const double size = d * std::sqrt(2.0 / kPi) * std::exp(-0.5 * m * m / (d * d)) +
                        m * std::erf(m / (d * std::sqrt(2.0)));
    const double expected = plain.h_abs - 0.5 * (size - m) / plain.mean;
    ASSERT_NEAR(with_noise_variance(plain, aspect, deviation, region).h_abs, expected, 2e-6) << i;
  }
}

// 200 noisy images of 4,096 pixels: their mean is known to about 1e-5.
TEST(WithNoiseVariance, AgreesWithNoisyImages) {
  ImageF aspect(kNoiseSide, kNoiseSide);
  ImageF deviation(kNoiseSide, kNoiseSide);
  const Mask region(kNoiseSide, kNoiseSide, 1);
  for (std::size_t i = 0; i < aspect.size(); ++i) {
    Rng rng(101, Stream::kTest, i);
    aspect.values()[i] = static_cast<float>(rng.uniform(0.4, 0.6));
    deviation.values()[i] = static_cast<float>(rng.uniform(0.0, 0.05));
  }
  double h_rms = 0.0;
  double h_abs = 0.0;
  constexpr int kImages = 200;
  for (int k = 0; k < kImages; ++k) {
    ImageF noisy = aspect;
    for (std::size_t i = 0; i < noisy.size(); ++i) {
      Rng rng(103, Stream::kTest, static_cast<std::uint64_t>(k) * aspect.size() + i);
      noisy.values()[i] +=
          static_cast<float>(normal_number(rng) * static_cast<double>(deviation.values()[i]));
    }
    const Homogeneity one = score_of(noisy, region);
    h_rms += one.h_rms / kImages;
    h_abs += one.h_abs / kImages;
  }
  const Homogeneity plain = score_of(aspect, region);
  const Homogeneity expected = with_noise_variance(plain, aspect, deviation, region);
  EXPECT_NEAR(expected.h_rms, h_rms, 1e-4);
  EXPECT_NEAR(expected.h_abs, h_abs, 1e-4);
  EXPECT_LT(expected.h_rms, plain.h_rms - 2e-3);
  EXPECT_LT(expected.h_abs, plain.h_abs - 2e-3);
}

}  // namespace
}  // namespace glint

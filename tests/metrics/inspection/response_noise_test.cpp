// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/response_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

ImageF gaussian_picture(int width_px, int height_px, double sigma, std::uint64_t index) {
  ImageF image(width_px, height_px);
  Rng rng(31, Stream::kTest, index);
  for (float& value : image.values()) {
    value = static_cast<float>(0.01 + sigma * rng.normal());
  }
  return image;
}

// Standard error of the estimate: 1.17 sigma / sqrt(2 * 390,000 / 2) = 0.19 % of sigma; 1 % is
// five.
TEST(RobustDeviation, IsSigmaOfGaussianNoiseWithinOnePercent) {
  ThreadPool pool(2);
  for (const double sigma : {1e-4, 0.003, 2.0}) {
    const ImageF image = gaussian_picture(1300, 300, sigma, 0);
    EXPECT_NEAR(robust_deviation(image, whole_image(1300, 300), pool), sigma, 0.01 * sigma);
  }
}

TEST(RobustDeviation, IsMovedLittleByDefects) {
  ThreadPool pool(2);
  ImageF image = gaussian_picture(600, 300, 0.003, 1);
  for (int y = 100; y < 130; ++y) {
    std::fill_n(image.row(y) + 50, 60, 0.9F);  // 1 % of the pixels
  }
  EXPECT_NEAR(robust_deviation(image, whole_image(600, 300), pool), 0.003, 0.03 * 0.003);
}

double by_sorting(const ImageF& image, const Spans& spans) {
  std::vector<float> values;
  for (const RowSpan& span : spans) {
    values.insert(values.end(), image.row(span.y) + span.begin, image.row(span.y) + span.end);
  }
  const auto median = [&] {
    std::ranges::sort(values);
    return values[(values.size() - 1) / 2];
  };
  const float middle = median();
  for (float& value : values) {
    value = std::abs(value - middle);
  }
  return 1.4826022185056018 * static_cast<double>(median());
}

TEST(RobustDeviation, IsExactForAnyRegionAndTies) {
  ThreadPool pool(3);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(32, Stream::kTest, i);
    ImageF image(static_cast<int>(rng.uniform(1.0, 200.0)),
                 static_cast<int>(rng.uniform(1.0, 40.0)));
    Mask mask(image.width(), image.height());
    const double levels = i % 2 == 0 ? 1e6 : 4.0;
    for (std::size_t k = 0; k < image.size(); ++k) {
      image.values()[k] = static_cast<float>(std::round(levels * rng.normal()) / levels);
      mask.values()[k] = rng.uniform() < 0.7 ? 1 : 0;
    }
    mask(0, 0) = 1;
    const Spans spans = spans_of(mask);
    ASSERT_EQ(robust_deviation(image, spans, pool), by_sorting(image, spans)) << "picture " << i;
  }
}

}  // namespace
}  // namespace glint

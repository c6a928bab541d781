// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/rng.h"
#include "simulator/sensor/sensor.h"

namespace glint {
namespace {

ImageF random_picture(int width_px, int height_px) {
  ImageF picture(width_px, height_px);
  Rng rng(3, Stream::kTest, 0);
  for (float& value : picture.values()) {
    value = static_cast<float>(rng.uniform());
  }
  return picture;
}

float largest_difference(const ImageF& a, const cv::Mat& b) {
  float largest = 0.0f;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      largest = std::max(largest, std::abs(a(x, y) - b.at<float>(y, x)));
    }
  }
  return largest;
}

TEST(SensorBlur, EqualsOpenCvWithReplicatedBorders) {
  ImageF picture = random_picture(131, 47);
  const cv::Mat source(47, 131, CV_32F, picture.values().data());
  for (const double sigma_px : {1.0, 1.15, 1.3, 2.0, 3.1, 8.0}) {
    SCOPED_TRACE(sigma_px);
    const int side = 2 * static_cast<int>(std::ceil(4.0 * sigma_px)) + 1;
    cv::Mat theirs;
    cv::GaussianBlur(source, theirs, {side, side}, sigma_px, sigma_px, cv::BORDER_REPLICATE);
    ImageF ours;
    Sensor({.blur_px = sigma_px, .bits = 0}, 131, 47).expose(picture, 0, ours);
    EXPECT_LT(largest_difference(ours, theirs), 2e-6f);
    cv::Mat other;
    cv::GaussianBlur(source, other, {side, side}, 1.1 * sigma_px, 0.0, cv::BORDER_REPLICATE);
    EXPECT_GT(largest_difference(ours, other), 1e-4f) << "the comparison cannot tell sigmas apart";
  }
}

}  // namespace
}  // namespace glint

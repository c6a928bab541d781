// SPDX-License-Identifier: GPL-3.0-or-later
//
// OpenCV's quality module on 8-bit pictures as a peer.
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/quality/qualitygmsd.hpp>
#include <opencv2/quality/qualityssim.hpp>

#include "core/rng.h"
#include "metrics/appearance/structure_similarity.h"

namespace glint {
namespace {

struct EightBits {
  ImageF picture{160, 120};
  cv::Mat codes = cv::Mat(120, 160, CV_8UC1);
};

/// Smooth structure with noise, the same for all strengths.
EightBits pattern(double noise, double shift_px) {
  EightBits result;
  Rng rng(9, Stream::kTest, 1);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const double grey = 120.0 + 60.0 * std::sin(0.21 * (x + shift_px)) * std::cos(0.13 * y) +
                          noise * rng.normal();
      const double code = std::round(std::fmin(std::fmax(grey, 0.0), 255.0));
      result.codes.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(code);
      result.picture(x, y) = static_cast<float>(code / 255.0);
    }
  }
  return result;
}

TEST(Ssim, AgreesWithOpenCvOnEightBits) {
  for (const double noise : {0.0, 4.0, 25.0}) {
    const EightBits a = pattern(0.0, 0.0);
    const EightBits b = pattern(noise, 0.7);
    const double theirs = cv::quality::QualitySSIM::compute(a.codes, b.codes, cv::noArray())[0];
    EXPECT_NEAR(ssim(a.picture, b.picture), theirs, 5e-4) << noise;
  }
}

/// Deviation of OpenCV's map without its outermost pixels, where it takes all beyond the picture
/// for black: a frame as bright as the picture, alike in both, which is no part of either.
double inner_deviation(const EightBits& a, const EightBits& b) {
  cv::Mat map;
  cv::quality::QualityGMSD::compute(a.codes, b.codes, map);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(map(cv::Rect(1, 1, map.cols - 2, map.rows - 2)), mean, deviation);
  return deviation[0];
}

Mask inner_region() {
  Mask inner(160, 120);
  for (int y = 2; y < 118; ++y) {
    for (int x = 2; x < 158; ++x) {
      inner(x, y) = 1;
    }
  }
  return inner;
}

TEST(Gmsd, AgreesWithOpenCvOnEightBitsButForTheFrame) {
  for (const double noise : {2.0, 10.0, 25.0}) {
    const EightBits a = pattern(0.0, 0.0);
    const EightBits b = pattern(noise, 0.7);
    const double theirs = inner_deviation(a, b);
    EXPECT_NEAR(gmsd(a.picture, b.picture, inner_region()), theirs, 1e-3 * theirs) << noise;
    // The frame, 1 pixel in 17, is what whole pictures differ by.
    const double framed = cv::quality::QualityGMSD::compute(a.codes, b.codes, cv::noArray())[0];
    EXPECT_NEAR(gmsd(a.picture, b.picture), framed, 0.13 * framed) << noise;
  }
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// OpenCV's quality module on 8-bit pictures as a peer.
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>
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

// Small noise comes through both reductions to half the size in different strength: within 13 %.
TEST(Gmsd, IsCloseToOpenCvOnEightBits) {
  for (const double noise : {2.0, 10.0, 25.0}) {
    const EightBits a = pattern(0.0, 0.0);
    const EightBits b = pattern(noise, 0.7);
    const double theirs = cv::quality::QualityGMSD::compute(a.codes, b.codes, cv::noArray())[0];
    EXPECT_NEAR(gmsd(a.picture, b.picture), theirs, 0.13 * theirs) << noise;
  }
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/rng.h"
#include "metrics/inspection/inspector.h"

namespace glint {
namespace {

TEST(InspectorResponse, IsThePictureMinusOpenCvsGaussianInTheInterior) {
  ImageF aspect(150, 110);
  Rng rng(61, Stream::kTest, 0);
  std::ranges::generate(aspect.values(), [&] { return static_cast<float>(rng.uniform()); });
  const cv::Mat source(110, 150, CV_32F, aspect.values().data());
  ThreadPool pool(2);
  for (const int kernel_px : {9, 11, 15, 31}) {
    for (const double sigma_px : {0.0, 1.3, 4.0}) {
      SCOPED_TRACE(::testing::Message() << kernel_px << " px, sigma " << sigma_px);
      const int rim_px = kernel_px / 2;
      const Inspector inspector(
          {.kernel_px = kernel_px, .sigma_px = sigma_px, .erosion_px = rim_px}, Mask(150, 110, 1));
      const ImageF ours = inspector.response(aspect, pool);
      cv::Mat smooth;
      // For 0 OpenCV has tables of rounded values for small kernels, so it is told the sigma.
      cv::GaussianBlur(
          source, smooth, {kernel_px, kernel_px}, gaussian_sigma(inspector.settings()));
      for (int y = rim_px; y < 110 - rim_px; ++y) {
        for (int x = rim_px; x < 150 - rim_px; ++x) {
          ASSERT_NEAR(ours(x, y), aspect(x, y) - smooth.at<float>(y, x), 2e-6F) << x << ", " << y;
        }
      }
      EXPECT_EQ(ours(0, 0), 0.0F) << "the rim has no response";
    }
  }
}

}  // namespace
}  // namespace glint

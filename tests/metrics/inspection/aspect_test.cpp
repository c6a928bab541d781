// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/rng.h"
#include "metrics/inspection/aspect.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Picture8 = Image<std::uint8_t>;

template <class T>
std::vector<Image<T>> random_frames(int count, int width_px, int height_px) {
  std::vector<Image<T>> frames;
  for (int j = 0; j < count; ++j) {
    Image<T> frame(width_px, height_px);
    Rng rng(11, Stream::kTest, static_cast<std::uint64_t>(j));
    for (T& value : frame.values()) {
      value = static_cast<T>(rng.next_u32());
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

template <class T>
void expect_exact_mean(const std::vector<Image<T>>& frames) {
  ThreadPool pool(2);
  const ImageF mean = aspect_of(std::span<const Image<T>>(frames), pool);
  const double divisor =
      static_cast<double>(frames.size()) * static_cast<double>(std::numeric_limits<T>::max());
  for (std::size_t i = 0; i < mean.size(); ++i) {
    std::uint64_t sum = 0;
    for (const Image<T>& frame : frames) {
      sum += frame.values()[i];
    }
    ASSERT_EQ(mean.values()[i], static_cast<float>(static_cast<double>(sum) / divisor)) << i;
  }
}

// 300 frames of 8 bits no longer fit into 16-bit sums; widths around a block of 64.
TEST(AspectOf, IsTheExactMeanOfCodes) {
  for (const int frames : {1, 2, 24, 257, 258, 300}) {
    for (const int width : {1, 63, 64, 65, 130}) {
      SCOPED_TRACE(::testing::Message() << frames << " frames, width " << width);
      expect_exact_mean(random_frames<std::uint8_t>(frames, width, 3));
    }
  }
  expect_exact_mean(random_frames<std::uint16_t>(3, 70, 20));
  expect_exact_mean(random_frames<std::uint16_t>(700, 9, 2));
}

TEST(AspectOf, GivesFullScaleForSaturatedFramesAndZeroForBlackOnes) {
  ThreadPool pool(1);
  const std::vector<Picture8> white(24, Picture8(5, 4, 255));
  const std::vector<Picture8> black(24, Picture8(5, 4, 0));
  EXPECT_EQ(aspect_of(white, pool), ImageF(5, 4, 1.0F));
  EXPECT_EQ(aspect_of(black, pool), ImageF(5, 4, 0.0F));
  const std::vector<ImageF> floats = {ImageF(5, 4, 0.25F), ImageF(5, 4, 0.75F)};
  EXPECT_EQ(aspect_of(floats, pool), ImageF(5, 4, 0.5F));
}

TEST(AspectOf, RefusesWhatHasNoMean) {
  ThreadPool pool(2);
  EXPECT_THAT([&] { aspect_of(std::vector<Picture8>{}, pool); },
              ThrowsMessage<ConfigError>(HasSubstr("no image")));
  EXPECT_THAT([&] { aspect_of(std::vector<Picture8>(1), pool); },
              ThrowsMessage<ConfigError>(HasSubstr("no pixel")));
  const std::vector<Picture8> sizes = {Picture8(5, 4), Picture8(4, 5)};
  EXPECT_THAT([&] { aspect_of(sizes, pool); },
              ThrowsMessage<ConfigError>(HasSubstr("image 2 has 4 x 5 px and image 1 has 5 x 4")));
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::vector<ImageF> frames(3, ImageF(40, 30, 0.5F));
    frames[1](7, 20) = bad;
    EXPECT_THAT([&] { aspect_of(frames, pool); },
                ThrowsMessage<ConfigError>(HasSubstr("pixel (7, 20) of image 2")));
  }
}

}  // namespace
}  // namespace glint

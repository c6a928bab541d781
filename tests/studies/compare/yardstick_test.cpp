// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/yardstick.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/compare/compared_pair.h"
#include "tests/metrics/overlap/drawn_edges.h"

namespace glint {
namespace {

/// Noise blurred by means of `size` x `size` pixels, of the given relative deviation.
TextureSample surface(double deviation, int size, std::uint64_t index) {
  ImageF white(256 + size, 256 + size, 0.0F);
  add_normal_noise(white, 1.0, index);
  ImageF picture(256, 256);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      double sum = 0.0;
      for (int k = 0; k < size * size; ++k) {
        sum += static_cast<double>(white(x + k % size, y + k / size));
      }
      picture(x, y) = static_cast<float>(0.5 * (1.0 + deviation * sum / size));
    }
  }
  const SurfaceTexture texture = texture_of(picture, {}, {.window_px = 128});
  return texture_sample("surface", picture, {}, texture);
}

/// Photographs that differ a little in how rough they are.
std::vector<TextureSample> photographs() {
  std::vector<TextureSample> reals;
  for (std::uint64_t i = 0; i < 5; ++i) {
    reals.push_back(surface(0.10 + 0.01 * static_cast<double>(i), 3, i));
  }
  return reals;
}

TEST(MeasureYardstick, IsAboutOneForAnotherOfTheKind) {
  const std::vector<TextureSample> simulated = {surface(0.12, 3, 20)};
  const auto stick = measure_yardstick(photographs(), simulated);
  ASSERT_TRUE(stick.has_value());
  EXPECT_EQ(stick->pairs, 10U);
  EXPECT_GT(stick->multiple, 0.4);
  EXPECT_LT(stick->multiple, 1.8);
  EXPECT_LE(stick->low, stick->multiple);
  EXPECT_GE(stick->high, stick->multiple);
}

TEST(MeasureYardstick, GrowsForAnotherSurface) {
  const std::vector<TextureSample> coarse = {surface(0.12, 9, 21)};
  const auto stick = measure_yardstick(photographs(), coarse);
  ASSERT_TRUE(stick.has_value());
  EXPECT_GT(stick->multiple, 3.0);
  EXPECT_GT(stick->low, 2.0);
}

TEST(MeasureYardstick, HasNoAnswerOfOnePhotographOrWithoutWindows) {
  std::vector<TextureSample> reals = photographs();
  EXPECT_FALSE(measure_yardstick({reals[0]}, {}).has_value());
  EXPECT_TRUE(measure_yardstick(reals, {}).has_value());
  reals[2].texture.windows = 0;
  EXPECT_FALSE(measure_yardstick(reals, {}).has_value());
}

// A part of which less is seen has smaller windows: all are compared in those.
TEST(MeasureYardstick, BringsWindowsToOneSize) {
  std::vector<TextureSample> other = {surface(0.12, 3, 22)};
  other[0].texture = texture_of(other[0].grey, {}, {.window_px = 64});
  const auto stick = measure_yardstick(photographs(), other);
  ASSERT_TRUE(stick.has_value());
  EXPECT_EQ(stick->window_px, 64);
  EXPECT_LT(stick->multiple, 1.8);
}

// Two samples by hand: greys {0.9, 1.1} over their mean against {0.8, 1.2} are 0.1 apart.
TEST(TextureSampleTest, HasGreysOverTheirMean) {
  ImageF faint(2, 1);
  faint.values() = {0.09F, 0.11F};
  const TextureSample sample = texture_sample("s", faint, {}, {});
  EXPECT_FLOAT_EQ(sample.grey(0, 0), 0.9F);
  EXPECT_FLOAT_EQ(sample.grey(1, 0), 1.1F);
}

/// A simulated surface beside the photograph of that name.
ComparedPair pair_with(const std::string& name, const TextureSample& photograph) {
  ComparedPair pair;
  const TextureSample simulated = surface(0.12, 9, 21);
  pair.simulated.source = {.name = "simulated", .picture = "simulated.png"};
  pair.simulated.grey = simulated.grey;
  pair.appearance.simulated = simulated.texture;
  pair.real.source = {.name = name, .picture = name + ".png"};
  pair.real.grey = photograph.grey;
  pair.appearance.real = photograph.texture;
  return pair;
}

// Copies differ by nothing: beside them any simulation would be endlessly far off.
TEST(YardstickPictures, CountsCopiesOfAPhotographOnce) {
  const std::vector<TextureSample> reals = photographs();
  YardstickPictures pictures;
  pictures.add(pair_with("a", reals[0]));
  pictures.add(pair_with("copy", reals[0]));
  EXPECT_FALSE(pictures.measure().has_value());
  EXPECT_THAT(pictures.notes(),
              ::testing::ElementsAre(::testing::HasSubstr("one and the same picture")));
  pictures.add(pair_with("d", reals[1]));
  pictures.add(pair_with("e", reals[2]));
  const auto stick = pictures.measure();
  ASSERT_TRUE(stick.has_value());
  EXPECT_EQ(stick->reals, 3U);
  const auto without = measure_yardstick({reals[0], reals[1], reals[2]}, {surface(0.12, 9, 21)});
  EXPECT_NEAR(stick->multiple, without->multiple, 1e-4 * without->multiple);
  EXPECT_THAT(pictures.notes(),
              ::testing::ElementsAre(::testing::EndsWith("do not count for the yardstick: copy.")));
}

}  // namespace
}  // namespace glint

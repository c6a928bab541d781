// SPDX-License-Identifier: GPL-3.0-or-later
//
// Kept random numbers and tabled quantiles change nothing but time.
#include <cmath>
#include <cstdint>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/sensor/pixel_noise.h"
#include "simulator/sensor/poisson_quantile.h"
#include "simulator/sensor/sensor.h"

namespace glint {
namespace {

constexpr int kWidth = 150;  // no multiple of a block
constexpr int kHeight = 7;

SensorSettings noisy() {
  return {.gain = 1.5, .blur_px = 0.8, .full_well_e = 2000.0, .read_noise_e = 6.0, .seed = 91357};
}

/// From black over a few electrons to clipping.
ImageF ramp() {
  ImageF radiance(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      radiance(x, y) = x < 20 ? 0.0F : static_cast<float>(std::exp(0.06 * (x - kWidth)));
    }
  }
  return radiance;
}

ImageF exposed(const Spans& where, int frame = 1) {
  ImageF grey(kWidth, kHeight);
  Sensor(noisy(), kWidth, kHeight).expose(ramp(), frame, where, grey);
  return grey;
}

/// Numbers of some pixels.
struct Numbers {
  std::vector<std::uint32_t> words;
  std::vector<float> shot, read;

  explicit Numbers(std::size_t count) : words(count), shot(count), read(count) {}

  PixelNoise to() { return {.words = words.data(), .shot = shot.data(), .read = read.data()}; }

  bool operator==(const Numbers&) const = default;
};

Numbers drawn(int seed, int frame, std::int64_t first, std::int64_t count) {
  Numbers numbers(static_cast<std::size_t>(count));
  draw_noise(seed, frame, first, count, numbers.to());
  return numbers;
}

Numbers loaded(KeptNoise& kept, int seed, int frame, std::int64_t first, std::int64_t count) {
  Numbers numbers(static_cast<std::size_t>(count));
  kept.load(seed, frame, first, count, numbers.to());
  return numbers;
}

constexpr std::size_t kBlockBytes = 64 * 12 + 16;

// A few pixels of a picture take kept numbers, all of it new ones.
TEST(KeptNoise, GivesFewPixelsTheGreyValuesOfTheWholePicture) {
  for (int round = 0; round < 2; ++round) {
    const ImageF whole = exposed(whole_image(kWidth, kHeight));
    const std::size_t before = shared_noise().kept_bytes();
    const Spans some = {{.y = 1, .begin = 3, .end = 149}, {.y = 6, .begin = 63, .end = 150}};
    const ImageF few = exposed(some);
    for (const RowSpan& span : some) {
      for (int x = span.begin; x < span.end; ++x) {
        ASSERT_EQ(few(x, span.y), whole(x, span.y)) << x << ' ' << span.y;
      }
    }
    EXPECT_EQ(shared_noise().kept_bytes() > before, round == 0) << "kept by the first scan";
    EXPECT_NE(few, exposed(some, 2)) << "another frame";
  }
}

TEST(KeptNoise, IsTheNoiseThatIsDrawn) {
  KeptNoise kept(std::size_t{1} << 20);
  for (int round = 0; round < 2; ++round) {
    for (const int seed : {0, 1, 0x7FFFFFFF}) {
      for (const int frame : {0, 1, 23}) {
        EXPECT_EQ(loaded(kept, seed, frame, 61, 200), drawn(seed, frame, 61, 200));
        EXPECT_EQ(loaded(kept, seed, frame, 127, 1), drawn(seed, frame, 127, 1));
      }
    }
  }
  EXPECT_EQ(kept.kept_bytes(), 3U * 3U * 5U * kBlockBytes);  // pixels 61 to 260: blocks 0 to 4
}

TEST(KeptNoise, KeepsNoMoreThanItMay) {
  for (const std::size_t blocks : {std::size_t{0}, std::size_t{1}, std::size_t{7}}) {
    KeptNoise kept(blocks * kBlockBytes);
    for (int round = 0; round < 2; ++round) {
      EXPECT_EQ(loaded(kept, 5, 2, 0, 5000), drawn(5, 2, 0, 5000));
      EXPECT_LE(kept.kept_bytes(), blocks * kBlockBytes);
    }
    EXPECT_EQ(kept.kept_bytes(), blocks * kBlockBytes);
  }
}

TEST(KeptNoise, MayBeAskedFromSeveralThreads) {
  KeptNoise kept(40 * kBlockBytes);  // for 16 blocks of the 5 frames there is no room
  const Numbers wanted = drawn(9, 3, 10, 700);
  std::vector<Numbers> found(8, Numbers(700));
  {
    std::vector<std::jthread> threads;
    for (Numbers& numbers : found) {
      threads.emplace_back([&] {
        for (const int frame : {0, 1, 2, 4, 3}) {
          numbers = loaded(kept, 9, frame, 10, 700);
        }
      });
    }
  }
  for (const Numbers& numbers : found) {
    EXPECT_EQ(numbers, wanted);
  }
  EXPECT_LE(kept.kept_bytes(), 40U * kBlockBytes);
}

TEST(PoissonQuantile, IsTheSummedOneForAnyMeanAndProbability) {
  Rng rng(3, Stream::kTest, 1);
  for (int i = 0; i < 300'000; ++i) {
    // As the sensor asks: a mean in float, a probability of 32 bits. Small means, and all of them.
    const double mean = static_cast<double>(static_cast<float>(
        i % 2 == 0 ? rng.uniform(0.0, 30.0) : std::exp(rng.uniform(-30.0, 3.4))));
    const double u = (rng.next_u32() + 0.5) * 0x1p-32;
    ASSERT_EQ(poisson_quantile(mean, u), summed_poisson_quantile(mean, u)) << mean << ' ' << u;
  }
}

TEST(PoissonQuantile, IsTheSummedOneAtTheEnds) {
  constexpr double kSmallest = 0.5 * 0x1p-32;
  constexpr double kLargest = 1.0 - 0.5 * 0x1p-32;
  for (const double mean : {0.0, 1e-30, 0x1p-33, 1e-9, 0.5, 1.0, 29.96875, 29.97, 29.9999, 30.0}) {
    for (const double u : {kSmallest, 0.5, kLargest}) {
      EXPECT_EQ(poisson_quantile(mean, u), summed_poisson_quantile(mean, u)) << mean << ' ' << u;
    }
  }
  EXPECT_EQ(poisson_quantile(0.5, 0.60), 0);  // e^-0.5 = 0.607
  EXPECT_EQ(poisson_quantile(0.5, 0.61), 1);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/appearance/unclipped_pixels.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "metrics/appearance/grey_sums.h"

namespace glint {
namespace {

constexpr int kRampWidth_px = 200;
constexpr double kRealNoise = 0.02;

/// From some grey to 5 % beyond full scale, and the same by a sensor that cuts off.
struct Ramp {
  ImageF simulated{kRampWidth_px, 100};
  ImageF real{kRampWidth_px, 100};

  explicit Ramp(double first) {
    Rng rng(22, Stream::kTest, 0);
    for (int y = 0; y < real.height(); ++y) {
      for (int x = 0; x < kRampWidth_px; ++x) {
        const double grey = first + (1.05 - first) * x / kRampWidth_px;
        simulated(x, y) = static_cast<float>(grey + 0.01 * rng.normal());
        real(x, y) = static_cast<float>(std::min(grey + kRealNoise * rng.normal(), 1.0));
      }
    }
  }

  Mask below_full_scale() const {
    Mask shown(real.width(), real.height());
    std::ranges::transform(real.values(), shown.values().begin(), [](float grey) {
      return static_cast<unsigned char>(grey < 1.0F ? 1 : 0);
    });
    return shown;
  }

  double gain_over(const std::vector<std::size_t>& pixels) const {
    GreySums sums;
    for (const std::size_t i : pixels) {
      sums.add(static_cast<double>(simulated.values()[i]), static_cast<double>(real.values()[i]));
    }
    return sums.products / sums.simulated_squares;
  }
};

// The simulated picture's noise makes the regression 0.01^2 / 0.93^2 = 1e-4 too flat, and the gain
// is sure to 0.02 / 0.93 / sqrt(7500) = 2.5e-4. Pixels that are chosen by their own values make it
// 2.6e-3 too small.
TEST(UnclippedPixels, AreThoseThatNoiseMadeBrighterToo) {
  const Ramp ramp(0.9);
  const Mask shown = ramp.below_full_scale();
  const std::vector<std::size_t> chosen = unclipped_pixels(ramp.simulated, ramp.real, shown, {});
  EXPECT_GT(chosen.size(), 7000U);
  EXPECT_NEAR(ramp.gain_over(chosen), 1.0, 1e-3);
  std::vector<std::size_t> each_by_itself;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (std::max(ramp.simulated.values()[i], ramp.real.values()[i]) < 0.98F) {
      each_by_itself.push_back(i);
    }
  }
  EXPECT_LT(ramp.gain_over(each_by_itself), 1.0 - 2e-3);
}

// A dark signal takes its share of full scale; noise that reducing has halved needs twice as much.
TEST(UnclippedPixels, LieClearOfFullScale) {
  const Ramp ramp(0.5);
  const Mask shown(kRampWidth_px, 100, 1);
  const auto last_column = [&](const UnclippedOptions& options) {
    int last = 0;
    for (const std::size_t i : unclipped_pixels(ramp.simulated, ramp.real, shown, options)) {
      last = std::max(last, static_cast<int>(i) % kRampWidth_px);
    }
    return last;
  };
  const double grey_per_px = 0.55 / kRampWidth_px;
  // The grey at which means of 25 pixels, 0.004 about it, lie two deviations below full scale.
  const double plain = 0.5 + grey_per_px * last_column({});
  EXPECT_NEAR(plain, 1.0 - 2.0 * kRealNoise, 0.02);
  EXPECT_NEAR(
      0.5 + grey_per_px * last_column({.noise_over_rest = 2.0}), plain - 2.0 * kRealNoise, 0.02);
  EXPECT_NEAR(0.5 + grey_per_px * last_column({.full_scale = 0.8}), plain - 0.2, 0.02);
}

TEST(UnclippedPixels, AreNoneOfABlackRendering) {
  const Ramp ramp(0.5);
  EXPECT_TRUE(
      unclipped_pixels(ImageF(kRampWidth_px, 100), ramp.real, ramp.below_full_scale(), {}).empty());
}

}  // namespace
}  // namespace glint

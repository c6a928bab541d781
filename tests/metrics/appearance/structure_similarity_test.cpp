// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/appearance/structure_similarity.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/rng.h"

namespace glint {
namespace {

ImageF noise(int width, int height, std::uint64_t index) {
  ImageF picture(width, height);
  Rng rng(2, Stream::kTest, index);
  for (float& grey : picture.values()) {
    grey = static_cast<float>(rng.uniform());
  }
  return picture;
}

// (2 0.3 0.6 + 0.0001) / (0.09 + 0.36 + 0.0001) = 0.80004; variances are 0.
TEST(Ssim, OfConstantPicturesComparesTheirGreys) {
  const ImageF a(30, 20, 0.3F);
  const ImageF b(30, 20, 0.6F);
  EXPECT_NEAR(ssim(a, b), 0.3601 / 0.4501, 1e-4);
  EXPECT_NEAR(ssim(a, a), 1.0, 1e-5);
}

// In units of 255 the same pictures with the range said have the same similarity.
TEST(Ssim, DependsOnTheRangeThatIsStated) {
  ImageF a = noise(40, 30, 0);
  ImageF b = noise(40, 30, 1);
  const double before = ssim(a, b, {}, 1.0);
  for (ImageF* picture : {&a, &b}) {
    for (float& grey : picture->values()) {
      grey *= 255.0F;
    }
  }
  EXPECT_NEAR(ssim(a, b, {}, 255.0), before, 1e-4);
  EXPECT_GT(std::abs(ssim(a, b, {}, 1.0) - before), 1e-3);  // the wrong range shows
}

/// The window sums of one pixel in double, from the definition.
double ssim_at(const ImageF& a, const ImageF& b, int x, int y) {
  double w = 0.0;
  double sa = 0.0;
  double sb = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  double ab = 0.0;
  for (int j = -5; j <= 5; ++j) {
    for (int i = -5; i <= 5; ++i) {
      const double weight = std::exp(-(i * i + j * j) / 4.5);
      const auto p = static_cast<double>(a(x + i, y + j));
      const auto q = static_cast<double>(b(x + i, y + j));
      w += weight;
      sa += weight * p;
      sb += weight * q;
      aa += weight * p * p;
      bb += weight * q * q;
      ab += weight * p * q;
    }
  }
  const double ma = sa / w;
  const double mb = sb / w;
  return (2 * ma * mb + 1e-4) * (2 * (ab / w - ma * mb) + 9e-4) /
         ((ma * ma + mb * mb + 1e-4) * (aa / w - ma * ma + bb / w - mb * mb + 9e-4));
}

TEST(SsimMap, IsWhatItsDefinitionSays) {
  const ImageF a = noise(37, 29, 2);
  ImageF b = noise(37, 29, 3);
  for (std::size_t i = 0; i < b.size(); ++i) {
    b.values()[i] = 0.6F * a.values()[i] + 0.4F * b.values()[i];
  }
  const ImageF map = ssim_map(a, b);
  for (int y = 5; y + 5 < 29; ++y) {
    for (int x = 5; x + 5 < 37; ++x) {
      ASSERT_NEAR(static_cast<double>(map(x, y)), ssim_at(a, b, x, y), 2e-5) << x << ", " << y;
    }
  }
}

// A picture narrower than the window is mirrored as often as it takes.
TEST(Ssim, TakesPicturesSmallerThanItsWindow) {
  EXPECT_NEAR(ssim(ImageF(3, 2, 0.3F), ImageF(3, 2, 0.6F)), 0.3601 / 0.4501, 1e-4);
  EXPECT_NEAR(ssim(ImageF(1, 1, 0.3F), ImageF(1, 1, 0.3F)), 1.0, 1e-5);
}

TEST(Ssim, IsTakenInTheRegionAlone) {
  ImageF a = noise(64, 32, 4);
  ImageF b = a;
  Mask region(64, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) {
      region(x, y) = x < 20 ? 1 : 0;
      b(x, y) = x >= 32 ? 0.0F : b(x, y);
    }
  }
  EXPECT_NEAR(ssim(a, b, region), 1.0, 1e-4);
  EXPECT_LT(ssim(a, b), 0.8);
}

TEST(Gmsd, IsZeroForEqualPicturesAndForOtherBrightness) {
  const ImageF a = noise(64, 64, 5);
  ImageF b = a;
  for (float& grey : b.values()) {
    grey += 0.1F;
  }
  EXPECT_NEAR(gmsd(a, a), 0.0, 1e-6);
  EXPECT_NEAR(gmsd(a, b), 0.0, 1e-4);
  EXPECT_GT(gmsd(a, noise(64, 64, 6)), 0.1);
}

// 8 x 4 pixels become 4 x 2. One has columns 0 0 1 1, the other is black: the gradient is 1 in the
// columns 1 and 2 (3 (1 - 0) / 3) and 0 elsewhere, so half of the pixels have t / (1 + t) and half
// have 1: deviation 0.5 (1 - t / (1 + t)) = 0.5 / (1 + t).
TEST(Gmsd, OfAnEdgeAgainstNothingIsWhatOneWorksOut) {
  ImageF edge(8, 4);
  for (int y = 0; y < 4; ++y) {
    for (int x = 4; x < 8; ++x) {
      edge(x, y) = 1.0F;
    }
  }
  const double t = 170.0 / 65025.0;
  EXPECT_NEAR(gmsd(edge, ImageF(8, 4)), 0.5 / (1.0 + t), 1e-6);
}

TEST(StructureSimilarity, RefusesDifferentSizes) {
  EXPECT_THROW(ssim(ImageF(4, 4), ImageF(4, 5)), ConfigError);
  EXPECT_THROW(gmsd(ImageF(4, 4), ImageF(4, 4), Mask(2, 2)), ConfigError);
}

}  // namespace
}  // namespace glint

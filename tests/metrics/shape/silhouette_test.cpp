// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/shape/silhouette.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

/// A picture with a disc of radius 40 in its middle; `grey` of the distance from there.
template <class Grey>
ImageF disc_picture(const Grey& grey) {
  ImageF image(121, 101);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      image(x, y) = static_cast<float>(grey(std::hypot(x - 60.0, y - 50.0)));
    }
  }
  return image;
}

void add_noise(ImageF& image, double deviation, std::uint64_t index) {
  Rng rng(1, Stream::kTest, index);
  for (float& grey : image.values()) {
    grey += static_cast<float>(deviation * rng.normal());
  }
}

int area_of(const Silhouette& silhouette) {
  const Mask mask = silhouette.mask.value_or(Mask());
  int area = 0;
  for (const unsigned char pixel : mask.values()) {
    area += pixel;
  }
  return area;
}

const double kDiscArea = kPi * 40.0 * 40.0;

// An edge blurred over some pixels keeps its place under Otsu's threshold.
TEST(FindSilhouette, HasTheAreaOfABlurredDisc) {
  ImageF image =
      disc_picture([](double r) { return 0.02 + 0.6 * 0.5 * std::erfc((r - 40.0) / 2.0); });
  add_noise(image, 0.005, 0);
  const Silhouette found = find_silhouette(image);
  ASSERT_TRUE(found.mask.has_value());
  EXPECT_FALSE(found.fault.has_value());
  EXPECT_FALSE(found.touches_border);
  EXPECT_NEAR(area_of(found), kDiscArea, 0.01 * kDiscArea);
  EXPECT_NEAR(found.contrast, 0.6, 0.03);
}

// Dark rings and a dark middle that no stripe lit are inside the outline.
TEST(FindSilhouette, FillsWhatIsDarkInside) {
  const ImageF image = disc_picture([](double r) {
    const bool is_lit = r <= 40.0 && r >= 10.0 && std::fmod(r, 12.0) < 8.0;
    return is_lit ? 0.5 : 0.0;
  });
  const Silhouette found = find_silhouette(image);
  EXPECT_NEAR(area_of(found), kDiscArea, 0.02 * kDiscArea);
}

TEST(FindSilhouette, LeavesWhatIsOpenToTheOutside) {
  ImageF image = disc_picture([](double r) { return r <= 40.0 ? 0.5 : 0.0; });
  for (int x = 60; x < 121; ++x) {
    image(x, 50) = 0.0F;  // a slit from the middle outwards
  }
  const Silhouette found = find_silhouette(image);
  ASSERT_TRUE(found.mask.has_value());
  EXPECT_EQ((*found.mask)(80, 50), 0);
  EXPECT_EQ((*found.mask)(80, 52), 1);
}

// |x - 20| + |y - 20| = 10 is closed though its pixels touch by corners only: 2 10 11 + 1 inside.
TEST(FindSilhouette, FillsWhatADiagonalLineEncloses) {
  ImageF image(41, 41);
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 41; ++x) {
      image(x, y) = std::abs(x - 20) + std::abs(y - 20) == 10 ? 0.8F : 0.0F;
    }
  }
  EXPECT_EQ(area_of(find_silhouette(image)), 221);
}

TEST(FindSilhouette, TakesTheLargestPieceOnly) {
  ImageF image = disc_picture([](double r) { return r <= 20.0 ? 0.5 : 0.0; });
  for (int y = 2; y < 10; ++y) {
    for (int x = 2; x < 10; ++x) {
      image(x, y) = 0.9F;
    }
  }
  const Silhouette found = find_silhouette(image);
  ASSERT_TRUE(found.mask.has_value());
  EXPECT_EQ((*found.mask)(5, 5), 0);
  EXPECT_EQ((*found.mask)(60, 50), 1);
  EXPECT_NEAR(area_of(found), kPi * 400.0, 20.0);
}

// A disc of radius 40 that a band of 7 rows cuts in two, as a camera slot's reflection does: the
// halves have pi 1600 less some 7 x 80 px, 7 x 3 px, below 1 % of a half, are a crumb.
TEST(FindSilhouette, KeepsAllPiecesButCrumbs) {
  ImageF image = disc_picture([](double r) { return r <= 40.0 ? 0.5 : 0.0; });
  for (int y = 47; y < 54; ++y) {
    for (int x = 0; x < image.width(); ++x) {
      image(x, y) = 0.02F;
    }
  }
  for (int y = 2; y < 5; ++y) {
    for (int x = 2; x < 9; ++x) {
      image(x, y) = 0.9F;
    }
  }
  const Silhouette largest = find_silhouette(image);
  EXPECT_EQ(largest.pieces, 1);
  EXPECT_NEAR(area_of(largest), 0.5 * (kDiscArea - 560.0), 30.0);
  const Silhouette all = find_silhouette(image, PartPieces::kAll);
  ASSERT_TRUE(all.mask.has_value());
  EXPECT_EQ(all.pieces, 2);
  EXPECT_NEAR(area_of(all), kDiscArea - 560.0, 60.0);
  EXPECT_EQ((*all.mask)(5, 3), 0) << "a crumb";
  EXPECT_EQ((*all.mask)(60, 50), 0) << "the band";
  EXPECT_EQ((*all.mask)(60, 40), 1);
  EXPECT_EQ((*all.mask)(60, 60), 1);
}

// A rim at 0.06 under a middle at 0.8.
TEST(FindSilhouette, CutsOffADarkRim) {
  ImageF image = disc_picture([](double r) { return r <= 25.0 ? 0.8 : r <= 40.0 ? 0.06 : 0.005; });
  add_noise(image, 0.003, 1);
  EXPECT_NEAR(area_of(find_silhouette(image)), kPi * 625.0, 60.0);
}

TEST(FindSilhouette, SaysWhyThereIsNone) {
  EXPECT_EQ(find_silhouette(ImageF(30, 20, 0.0F)).fault, NoSilhouette::kDark);
  EXPECT_EQ(find_silhouette(ImageF(30, 20, 1.0F)).fault, NoSilhouette::kSaturated);
  EXPECT_EQ(find_silhouette(ImageF(30, 20, 0.4F)).fault, NoSilhouette::kNoContrast);
  ImageF hot(30, 20, 0.0F);
  hot(7, 7) = 1.0F;
  EXPECT_EQ(find_silhouette(hot).fault, NoSilhouette::kTooSmall);
  EXPECT_EQ(find_silhouette(disc_picture([](double r) { return r <= 40.0 ? 0.1 : 0.9; })).fault,
            NoSilhouette::kFillsPicture);  // brighter around than on the part
  for (const auto reason : {NoSilhouette::kDark,
                            NoSilhouette::kSaturated,
                            NoSilhouette::kNoContrast,
                            NoSilhouette::kTooSmall,
                            NoSilhouette::kFillsPicture}) {
    EXPECT_GT(sentence(reason).size(), 20U);
  }
}

TEST(FindSilhouette, FindsNoneInNoise) {
  for (std::uint64_t i = 0; i < 100; ++i) {
    ImageF image(40, 40, 0.3F);
    add_noise(image, 0.01 + 0.001 * static_cast<double>(i), 10 + i);
    const Silhouette found = find_silhouette(image);
    ASSERT_FALSE(found.mask.has_value());
    EXPECT_EQ(found.fault, NoSilhouette::kNoContrast);
  }
}

TEST(FindSilhouette, SeesThatThePartLeavesThePicture) {
  ImageF image(50, 40);
  for (int y = 10; y < 30; ++y) {
    for (int x = 20; x < 50; ++x) {
      image(x, y) = 0.5F;
    }
  }
  const Silhouette found = find_silhouette(image);
  EXPECT_EQ(area_of(found), 600);
  EXPECT_TRUE(found.touches_border);
}

TEST(FindSilhouette, RefusesNoPictureAndNoNumbers) {
  EXPECT_THROW(find_silhouette(ImageF()), ConfigError);
  ImageF image(10, 10, 0.5F);
  image(3, 3) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(find_silhouette(image), ConfigError);
  image(3, 3) = std::numeric_limits<float>::infinity();
  EXPECT_THROW(find_silhouette(image), ConfigError);
}

TEST(FindSilhouette, BearsPicturesOfOnePixelOrRow) {
  EXPECT_TRUE(find_silhouette(ImageF(1, 1, 0.5F)).fault.has_value());
  ImageF row(60, 1);
  for (int x = 20; x < 40; ++x) {
    row(x, 0) = 0.5F;
  }
  EXPECT_EQ(area_of(find_silhouette(row)), 20);
}

}  // namespace
}  // namespace glint

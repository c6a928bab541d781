// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/undistortion.h"

#include <cmath>

#include <gtest/gtest.h>

namespace glint {
namespace {

PinholeIntrinsics lens() {
  return {.width_px = 320,
          .height_px = 240,
          .focal_px = {260.0, 258.0},
          .center_px = {165.0, 118.0},
          .radial = {-0.25, 0.08, 0.0},
          .tangential = {1e-3, -8e-4}};
}

PinholeIntrinsics straight_lens() {
  PinholeIntrinsics straight = lens();
  straight.radial = {0, 0, 0};
  straight.tangential = {0, 0};
  return straight;
}

/// What the real camera sees of a pattern in the plane z = 1; pixels' middles.
template <class Pattern>
ImageF photographed(const PinholeIntrinsics& camera, const Pattern& pattern) {
  const PinholeCamera real(camera);
  ImageF image(camera.width_px, camera.height_px);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const auto ray = real.ray_through({x + 0.5, y + 0.5});
      image(x, y) =
          ray ? static_cast<float>(pattern(ray->x() / ray->z(), ray->y() / ray->z())) : 0.0F;
    }
  }
  return image;
}

TEST(Undistortion, ShowsAPatternAsACameraWithoutDistortionDoes) {
  ThreadPool pool(2);
  const auto waves = [](double x, double y) { return 0.5 + 0.4 * std::sin(22.0 * x + 9.0 * y); };
  const ImageF straight = Undistortion(lens(), pool)(photographed(lens(), waves), pool);
  const ImageF truth = photographed(straight_lens(), waves);
  for (int y = 3; y < straight.height() - 3; ++y) {
    for (int x = 3; x < straight.width() - 3; ++x) {
      EXPECT_NEAR(straight(x, y), truth(x, y), 4e-4F) << x << " " << y;
    }
  }
}

/// How far the dark line in each row is from the straight line through the first and the last, px.
double bend_of(const ImageF& image) {
  std::vector<double> places;
  for (int y = 4; y < image.height() - 4; ++y) {
    double weight = 0.0;
    double sum = 0.0;
    for (int x = 0; x < image.width(); ++x) {
      const double dark = 1.0 - static_cast<double>(image(x, y));
      weight += dark;
      sum += dark * (x + 0.5);
    }
    places.push_back(sum / weight);
  }
  double most = 0.0;
  const double rows = static_cast<double>(places.size() - 1);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double share = static_cast<double>(i) / rows;
    most = std::max(most,
                    std::abs(places[i] - (1.0 - share) * places.front() - share * places.back()));
  }
  return most;
}

TEST(Undistortion, MakesLinesStraight) {
  ThreadPool pool(2);
  // A dark line near the left edge, a little slanted, some px wide.
  const auto line = [](double x, double y) {
    const double away = (x + 0.45 - 0.05 * y) * 260.0 / 2.0;
    return 1.0 - std::exp(-0.5 * away * away);
  };
  const ImageF bent = photographed(lens(), line);
  EXPECT_GT(bend_of(bent), 3.0);
  EXPECT_LT(bend_of(Undistortion(lens(), pool)(bent, pool)), 0.01);
}

TEST(Undistortion, KeepsAPictureWithoutDistortion) {
  ThreadPool pool(1);
  ImageF image(320, 240);
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.values()[i] = static_cast<float>((i * 37) % 256) / 255.0F;
  }
  const Undistortion undistortion(straight_lens(), pool);
  EXPECT_EQ(undistortion(image, pool), image);
  EXPECT_EQ(undistortion.outside_share(), 0.0);
}

TEST(Undistortion, IsBlackWhereTheRealPictureShowsNothing) {
  ThreadPool pool(1);
  PinholeIntrinsics pincushion = lens();
  pincushion.radial = {0.2, 0.0, 0.0};
  const Undistortion undistortion(pincushion, pool);
  EXPECT_GT(undistortion.outside_share(), 0.05);
  const ImageF straight = undistortion(ImageF(320, 240, 0.7F), pool);
  EXPECT_EQ(straight(0, 0), 0.0F);
  EXPECT_NEAR(straight(160, 120), 0.7F, 1e-6F);
  std::size_t black = 0;
  for (const float value : straight.values()) {
    black += value == 0.0F ? 1 : 0;
  }
  EXPECT_EQ(undistortion.outside_share(),
            static_cast<double>(black) / static_cast<double>(straight.size()));
}

TEST(Undistortion, IsTheSameForAnyNumberOfThreads) {
  ThreadPool one(1);
  ThreadPool two(2);
  const ImageF image = photographed(lens(), [](double x, double y) { return x * x + 0.3 * y; });
  EXPECT_EQ(Undistortion(lens(), one)(image, one), Undistortion(lens(), two)(image, two));
}

}  // namespace
}  // namespace glint

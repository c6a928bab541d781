// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/blobs.h"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

using Polarity = InspectionSettings::Polarity;
using Pixels = std::vector<std::pair<int, int>>;

std::vector<FoundDefect> blobs_in(const ImageF& response,
                                  double threshold,
                                  const InspectionSettings& settings = {.min_area_px = 1}) {
  ThreadPool pool(2);
  return find_blobs(response, threshold, settings, pool);
}

ImageF drawn(const Pixels& pixels, float value = 1.0F) {
  ImageF image(20, 20);
  for (const auto& [x, y] : pixels) {
    image(x, y) = value;
  }
  return image;
}

// Three pixels in a row: variance (1 + 0 + 1) / 3 + 1/12 = 3/4 along, 1/12 across; 4 sqrt(3/4) =
// 3.4641, 4 sqrt(1/12) = 1.1547; elongation (3/4 - 1/12) / (3/4 + 1/12) = 0.8.
TEST(FindBlobs, MeasuresARowOfThreePixels) {
  const auto found = blobs_in(drawn({{4, 7}, {5, 7}, {6, 7}}, 0.5F), 0.5);
  ASSERT_EQ(found.size(), 1U);
  const FoundDefect& row = found[0];
  EXPECT_DOUBLE_EQ(row.x_px, 5.5);
  EXPECT_DOUBLE_EQ(row.y_px, 7.5);
  EXPECT_EQ(row.area_px, 3);
  EXPECT_DOUBLE_EQ(row.weight, 1.5);
  EXPECT_DOUBLE_EQ(row.peak, 0.5);
  EXPECT_TRUE(row.is_bright);
  EXPECT_NEAR(row.length_px, 4.0 * std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(row.width_px, 4.0 * std::sqrt(1.0 / 12.0), 1e-12);
  EXPECT_NEAR(row.elongation, 0.8, 1e-12);
  EXPECT_DOUBLE_EQ(row.angle_rad, 0.0);
  EXPECT_EQ(row.left_px, 4);
  EXPECT_EQ(row.right_px, 7);
  EXPECT_EQ(row.top_px, 7);
  EXPECT_EQ(row.bottom_px, 8);
}

// Two pixels corner to corner: mu20 = mu02 = 1/4 + 1/12 = 1/3, mu11 = +-1/4; l = 7/12 and 1/12.
TEST(FindBlobs, JoinsCornersAndGivesTheAngleDownwards) {
  const auto down = blobs_in(drawn({{3, 3}, {4, 4}}), 0.5);
  ASSERT_EQ(down.size(), 1U);
  EXPECT_NEAR(down[0].angle_rad, 0.25 * kPi, 1e-12);
  EXPECT_NEAR(down[0].length_px, 4.0 * std::sqrt(7.0 / 12.0), 1e-12);
  EXPECT_NEAR(down[0].elongation, 0.75, 1e-12);
  const auto up = blobs_in(drawn({{4, 3}, {3, 4}}), 0.5);
  ASSERT_EQ(up.size(), 1U);
  EXPECT_NEAR(up[0].angle_rad, -0.25 * kPi, 1e-12);
  const auto column = blobs_in(drawn({{4, 3}, {4, 4}}), 0.5);
  EXPECT_NEAR(column[0].angle_rad, 0.5 * kPi, 1e-12);
}

TEST(FindBlobs, NeverJoinsBrightWithDark) {
  ImageF image = drawn({{4, 4}, {5, 4}, {4, 5}});
  image(6, 4) = -2.0F;
  image(5, 5) = -1.0F;
  const auto found = blobs_in(image, 1.0);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].area_px, 3);
  EXPECT_FALSE(found[1].is_bright);
  EXPECT_EQ(found[1].area_px, 2);
  EXPECT_DOUBLE_EQ(found[1].peak, 2.0);
  const auto bright = blobs_in(image, 1.0, {.polarity = Polarity::kBright, .min_area_px = 1});
  ASSERT_EQ(bright.size(), 1U);
  EXPECT_TRUE(bright[0].is_bright);
  const auto dark = blobs_in(image, 1.0, {.polarity = Polarity::kDark, .min_area_px = 1});
  ASSERT_EQ(dark.size(), 1U);
  EXPECT_FALSE(dark[0].is_bright);
}

// 0.1F is 0.100000001490116: the double above it is the first threshold that it does not reach.
TEST(FindBlobs, CompareWithTheThresholdToTheLastBitOfADouble) {
  ImageF image(5, 5);
  image(2, 2) = 0.1F;
  const auto grey = static_cast<double>(0.1F);
  EXPECT_EQ(blobs_in(image, grey).size(), 1U);
  EXPECT_TRUE(blobs_in(image, std::nextafter(grey, 1.0)).empty());
}

TEST(FindBlobs, LeavesOutWhatIsSmallerThanAsked) {
  const ImageF image = drawn({{1, 1}, {5, 5}, {6, 5}});
  EXPECT_EQ(blobs_in(image, 0.5, {.min_area_px = 1}).size(), 2U);
  EXPECT_EQ(blobs_in(image, 0.5, {.min_area_px = 2}).size(), 1U);
  EXPECT_TRUE(blobs_in(image, 0.5, {.min_area_px = 3}).empty());
}

TEST(PixelSums, LoseNothingFarFromTheOrigin) {
  PixelSums near;
  PixelSums far;
  for (int y = 0; y < 3; ++y) {
    near.add(sums_of_run(y, y, y + 5));
    far.add(sums_of_run(29000 + y, 28000 + y, 28000 + y + 5));
  }
  EXPECT_NEAR(moments_of(far).mu20, moments_of(near).mu20, 1e-12);
  EXPECT_NEAR(moments_of(far).mu11, moments_of(near).mu11, 1e-12);
  EXPECT_NEAR(moments_of(far).mu02, moments_of(near).mu02, 1e-12);
}

/// Blobs by flood fill, moments by their definition.
class FloodFill {
 public:
  FloodFill(const ImageF& image, double threshold) : image_(image), threshold_(threshold) {
    Mask seen(image.width(), image.height());
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        if (seen(x, y) == 0 && sign_at(x, y) != 0) {
          blobs.push_back(fill(x, y, seen));
        }
      }
    }
  }

  std::vector<Pixels> blobs;

 private:
  int sign_at(int x, int y) const {
    if (x < 0 || y < 0 || x >= image_.width() || y >= image_.height()) {
      return 0;
    }
    const auto value = static_cast<double>(image_(x, y));
    return std::abs(value) >= threshold_ ? (value > 0.0 ? 1 : -1) : 0;
  }

  Pixels fill(int x, int y, Mask& seen) const {
    Pixels pixels = {{x, y}};
    seen(x, y) = 1;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const auto [px, py] = pixels[i];
      for (int v = py - 1; v <= py + 1; ++v) {
        for (int u = px - 1; u <= px + 1; ++u) {
          if (sign_at(u, v) == sign_at(x, y) && seen(u, v) == 0) {
            seen(u, v) = 1;
            pixels.emplace_back(u, v);
          }
        }
      }
    }
    return pixels;
  }

  const ImageF& image_;
  double threshold_;
};

void expect_same(const FoundDefect& found, const Pixels& pixels, const ImageF& image) {
  const auto count = static_cast<double>(pixels.size());
  double x = 0.0;
  double y = 0.0;
  double weight = 0.0;
  for (const auto& [px, py] : pixels) {
    x += (px + 0.5) / count;
    y += (py + 0.5) / count;
    weight += std::abs(static_cast<double>(image(px, py)));
  }
  double mu20 = 1.0 / 12.0;
  double mu11 = 0.0;
  double mu02 = 1.0 / 12.0;
  for (const auto& [px, py] : pixels) {
    mu20 += (px + 0.5 - x) * (px + 0.5 - x) / count;
    mu11 += (px + 0.5 - x) * (py + 0.5 - y) / count;
    mu02 += (py + 0.5 - y) * (py + 0.5 - y) / count;
  }
  const double root = std::hypot(mu20 - mu02, 2.0 * mu11);
  ASSERT_EQ(found.area_px, static_cast<int>(pixels.size()));
  EXPECT_NEAR(found.x_px, x, 1e-9);
  EXPECT_NEAR(found.y_px, y, 1e-9);
  EXPECT_NEAR(found.weight, weight, 1e-9);
  EXPECT_NEAR(found.elongation, root / (mu20 + mu02), 1e-9);
  EXPECT_NEAR(found.length_px, 4.0 * std::sqrt(0.5 * (mu20 + mu02 + root)), 1e-9);
}

// Sparse to dense, so that blobs are specks, mazes and nearly everything.
TEST(FindBlobs, AgreeWithAFloodFillOnRandomPictures) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(21, Stream::kTest, i);
    ImageF image(static_cast<int>(rng.uniform(1.0, 90.0)),
                 static_cast<int>(rng.uniform(1.0, 40.0)));
    for (float& value : image.values()) {
      value = static_cast<float>(rng.normal());
    }
    const double threshold = rng.uniform(0.05, 2.5);
    const FloodFill expected(image, threshold);
    const auto found = blobs_in(image, threshold);
    ASSERT_EQ(found.size(), expected.blobs.size()) << "picture " << i;
    for (std::size_t k = 0; k < found.size(); ++k) {
      expect_same(found[k], expected.blobs[k], image);
    }
  }
}

/// A line of 40 x 2 px and a disc of radius 8 px, as second moments.
BlobMoments turned_line(double angle_rad) {
  const double along = 1600.0 / 12.0;
  const double across = 4.0 / 12.0;
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return {.mu20 = along * c * c + across * s * s,
          .mu11 = (along - across) * c * s,
          .mu02 = along * s * s + across * c * c};
}

TEST(KindOf, TellsALineFromADiscAtAnyAngle) {
  for (int degrees = 0; degrees < 180; ++degrees) {
    EXPECT_EQ(kind_of(turned_line(degrees * kPi / 180.0), 80, {}), DefectKind::kScratch);
  }
  EXPECT_EQ(kind_of({.mu20 = 16.0, .mu11 = 0.0, .mu02 = 16.0}, 201, {}), DefectKind::kHole);
  EXPECT_EQ(kind_of(turned_line(0.3), 11, {.hole_below_px = 12}), DefectKind::kHole);
}

/// How often the printed rule calls a line of that width a hole, over 180 directions.
int holes_by_printed_rule(double widening) {
  const InspectionSettings printed{.kind_rule = InspectionSettings::KindRule::kPrinted};
  int holes = 0;
  for (int degrees = 0; degrees < 180; ++degrees) {
    BlobMoments moments = turned_line((degrees + 0.25) * kPi / 180.0);
    moments.mu20 += widening;  // thickens the line evenly: only its elongation changes
    moments.mu02 += widening;
    holes += kind_of(moments, 80, printed) == DefectKind::kHole ? 1 : 0;
  }
  return holes;
}

// (mu02 - mu20) / mu11 = -2 cot 2t: elongation cancels. With k = 1 one of the ratios is at least 1
// where -2 cot 2t is >= 1 or in (0, 1]: whenever it is positive, half of all directions.
TEST(KindOf, PrintedRuleSeesTheDirectionOnly) {
  const int of_thin_lines = holes_by_printed_rule(0.0);
  EXPECT_EQ(of_thin_lines, 90);
  EXPECT_EQ(holes_by_printed_rule(10.0), of_thin_lines);
  EXPECT_EQ(holes_by_printed_rule(1e4), of_thin_lines) << "nearly round, and still";
  const InspectionSettings printed{.kind_rule = InspectionSettings::KindRule::kPrinted};
  EXPECT_EQ(kind_of({.mu20 = 16.0, .mu11 = 0.0, .mu02 = 16.0}, 201, printed), DefectKind::kScratch)
      << "0 / 0: a disc is a scratch";
}

}  // namespace
}  // namespace glint

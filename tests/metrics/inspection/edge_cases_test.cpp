// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures, masks and settings at the ends of what is allowed.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "metrics/inspection/blobs.h"
#include "metrics/inspection/calibration.h"
#include "metrics/inspection/inspector.h"

namespace glint {
namespace {

using EdgePolarity = InspectionSettings::Polarity;
using EdgeFilter = InspectionSettings::Filter;
using EdgeThreshold = InspectionSettings::Threshold;

std::vector<InspectionSettings> extreme_filters() {
  const InspectionSettings plain{.erosion_px = 0, .min_area_px = 1};
  InspectionSettings widest = plain;
  widest.kernel_px = 255;
  widest.sigma_px = 100.0;
  InspectionSettings sharpest = plain;
  sharpest.kernel_px = 3;
  sharpest.sigma_px = 1e-3;
  InspectionSettings scales = plain;
  scales.filter = EdgeFilter::kDifferenceOfGaussians;
  scales.scales_px = {0.3, 40.0};
  InspectionSettings spot = plain;
  spot.filter = EdgeFilter::kMatched;
  spot.template_px = 1.0;
  InspectionSettings wide_spot = spot;
  wide_spot.template_px = 100.0;
  return {plain, widest, sharpest, scales, spot, wide_spot};
}

void expect_sound(const Inspection& inspection, const Mask& mask) {
  EXPECT_TRUE(std::isfinite(inspection.threshold));
  for (const FoundDefect& found : inspection.defects) {
    ASSERT_GE(found.left_px, 0);
    ASSERT_GE(found.top_px, 0);
    ASSERT_LE(found.right_px, mask.width());
    ASSERT_LE(found.bottom_px, mask.height());
    ASSERT_GE(found.area_px, 1);
    ASSERT_LE(found.area_px, mask.width() * mask.height());
    ASSERT_TRUE(std::isfinite(found.weight + found.peak + found.length_px + found.width_px));
    ASSERT_TRUE(found.elongation >= 0.0 && found.elongation <= 1.0) << found.elongation;
  }
}

TEST(InspectorEdges, PicturesOfOnePixelRowOrColumnAreInspectedByAnyFilter) {
  ThreadPool pool(2);
  for (const auto& [width, height] : {std::pair(1, 1), {1, 40}, {40, 1}, {2, 2}, {300, 1}}) {
    const Mask mask(width, height, 1);
    ImageF aspect(width, height);
    Rng rng(51, Stream::kTest, static_cast<std::uint64_t>(width));
    std::ranges::generate(aspect.values(), [&] { return static_cast<float>(rng.uniform()); });
    for (const InspectionSettings& settings : extreme_filters()) {
      const Inspector inspector(settings, mask);
      expect_sound(inspector.inspect(aspect, pool), mask);
      const std::vector<Image<std::uint8_t>> frame(1, Image<std::uint8_t>(width, height, 77));
      EXPECT_TRUE(inspector.inspect(frame, pool).defects.empty());
    }
  }
}

// A pixel alone is its own surroundings; a line one pixel wide has those along it only.
TEST(InspectorEdges, MasksOneWideOrOfScatteredPixelsAreInspected) {
  ThreadPool pool(2);
  Mask lines(60, 50);
  Mask dots(60, 50);
  ImageF aspect(60, 50);
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 60; ++x) {
      lines(x, y) = x == 7 || y == 49 ? 1 : 0;
      dots(x, y) = x % 20 == 0 && y % 20 == 0 ? 1 : 0;
      aspect(x, y) = x == 7 && y == 20 ? 0.9F : 0.4F;
    }
  }
  for (const InspectionSettings& settings : extreme_filters()) {
    expect_sound(Inspector(settings, lines).inspect(aspect, pool), lines);
    expect_sound(Inspector(settings, dots).inspect(aspect, pool), dots);
  }
  const InspectionSettings fixed{
      .threshold = EdgeThreshold::kFixed, .erosion_px = 0, .min_area_px = 1};
  EXPECT_TRUE(Inspector(fixed, dots).inspect(aspect, pool).defects.empty());
  const Inspection on_line = Inspector(fixed, lines).inspect(aspect, pool);
  const auto bright = std::ranges::find_if(
      on_line.defects, [](const FoundDefect& found) { return found.is_bright; });
  ASSERT_NE(bright, on_line.defects.end());
  EXPECT_EQ(bright->x_px, 7.5);
  EXPECT_EQ(bright->y_px, 20.5);
}

TEST(InspectorEdges, MasksThatTouchAllBordersGiveFiniteResponsesUpToThem) {
  ThreadPool pool(2);
  const Mask mask(90, 70, 1);
  ImageF aspect(90, 70, 0.5F);
  for (const auto& [x, y] : {std::pair(0, 0), {89, 0}, {0, 69}, {89, 69}}) {
    aspect(x, y) = 1.0F;
  }
  const Inspector inspector({.threshold = EdgeThreshold::kFixed,
                             .polarity = EdgePolarity::kBright,
                             .erosion_px = 0,
                             .min_area_px = 1},
                            mask);
  const Inspection found = inspector.inspect(aspect, pool);
  ASSERT_EQ(found.defects.size(), 4U);
  EXPECT_EQ(found.defects[3].x_px, 89.5);
  EXPECT_EQ(found.defects[3].y_px, 69.5);
}

TEST(InspectorEdges, LargestGreysGiveFiniteResponses) {
  ThreadPool pool(2);
  ImageF aspect(50, 40, kLargestGrey);
  aspect(25, 20) = -kLargestGrey;
  const Mask mask(50, 40, 1);
  for (const InspectionSettings& settings : extreme_filters()) {
    const ImageF response = Inspector(settings, mask).response(aspect, pool);
    EXPECT_TRUE(std::ranges::all_of(response.values(), [](float v) { return std::isfinite(v); }));
  }
}

// 362 x 362 / 2 pixels of a checkerboard: corners touch, so that each sign is one blob.
TEST(FindBlobsEdges, OfACheckerboardAreOneOfEachSign) {
  ThreadPool pool(3);
  ImageF board(362, 362);
  for (int y = 0; y < 362; ++y) {
    for (int x = 0; x < 362; ++x) {
      board(x, y) = (x + y) % 2 == 0 ? 0.5F : -0.5F;
    }
  }
  const auto blobs = find_blobs(board, 0.1, {}, pool);
  ASSERT_EQ(blobs.size(), 2U);
  EXPECT_EQ(blobs[0].area_px, 362 * 362 / 2);
  EXPECT_EQ(blobs[1].area_px, 362 * 362 / 2);
  EXPECT_EQ(blobs[0].weight, 0.5 * 362 * 362 / 2);
}

TEST(FindBlobsEdges, MayBeMoreThan16BitsCount) {
  ThreadPool pool(3);
  ImageF dots(2 * 300, 2 * 300);
  for (int y = 0; y < 600; y += 2) {
    for (int x = 0; x < 600; x += 2) {
      dots(x, y) = 1.0F;
    }
  }
  const auto blobs = find_blobs(dots, 0.5, {.min_area_px = 1}, pool);
  ASSERT_EQ(blobs.size(), 90000U);
  EXPECT_EQ(blobs[89999].x_px, 598.5);
  EXPECT_EQ(blobs[89999].y_px, 598.5);
}

TEST(FindBlobsEdges, OfEqualPicturesAreAllOrNone) {
  ThreadPool pool(2);
  const ImageF even(70, 33, 0.25F);
  EXPECT_TRUE(find_blobs(even, 0.26, {}, pool).empty());
  const auto whole = find_blobs(even, 0.25, {}, pool);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(whole[0].area_px, 70 * 33);
  EXPECT_TRUE(find_blobs(ImageF(70, 33), 1e-300, {}, pool).empty()) << "zero is no response";
  EXPECT_TRUE(find_blobs(even, 1e300, {}, pool).empty()) << "beyond all floats";
  EXPECT_TRUE(find_blobs(ImageF(), 0.1, {}, pool).empty());
}

TEST(ThresholdForEdges, EndsForAnyRateAndPolarity) {
  ThreadPool pool(2);
  std::vector<ImageF> responses(2, ImageF(40, 30));
  responses[0](10, 10) = 0.3F;
  responses[1](20, 20) = -0.2F;
  const auto threshold = [&](EdgePolarity polarity, double rate) {
    const Inspector inspector({.polarity = polarity, .min_area_px = 1}, Mask(40, 30, 1));
    return threshold_for(inspector, responses, rate, pool);
  };
  const auto above = [](float v) { return static_cast<double>(std::nextafter(v, 1.0F)); };
  EXPECT_EQ(threshold(EdgePolarity::kBoth, 1e-300), above(0.3F));
  EXPECT_EQ(threshold(EdgePolarity::kBright, 0.1), above(0.3F));
  EXPECT_EQ(threshold(EdgePolarity::kDark, 0.1), above(0.2F));
  EXPECT_EQ(threshold(EdgePolarity::kBoth, 0.5), above(0.2F)) << "one blob in two pictures";
  EXPECT_EQ(threshold(EdgePolarity::kBoth, 1.0), kMinThreshold);
  EXPECT_EQ(threshold(EdgePolarity::kBoth, 1e300), kMinThreshold);
}

}  // namespace
}  // namespace glint

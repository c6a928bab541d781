// SPDX-License-Identifier: GPL-3.0-or-later
//
// Random defects, drawn with soft edges and noise, through the whole inspector.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "metrics/inspection/inspector.h"

namespace glint {
namespace {

constexpr int kSide = 120;

struct Shape {
  DefectKind kind = DefectKind::kHole;
  double length_px = 0.0;
  double width_px = 0.0;
  double angle_rad = 0.0;
  double x_px = 0.0;
  double y_px = 0.0;
  double height = 0.0;
};

/// Holes are ellipses of axis ratio up to 1.4; scratches at least 3 times as long as wide.
Shape random_shape(Rng& rng, DefectKind kind) {
  Shape shape{.kind = kind, .length_px = 5.0 * std::pow(12.0, rng.uniform())};
  const bool is_hole = kind == DefectKind::kHole;
  const double ratio = is_hole ? rng.uniform(1.0, 1.4) : rng.uniform(3.0, 12.0);
  shape.width_px = std::max(is_hole ? 3.0 : 1.0, shape.length_px / ratio);
  shape.angle_rad = rng.uniform(0.0, kPi);
  shape.x_px = 0.5 * kSide + rng.uniform(-0.5, 0.5);
  shape.y_px = 0.5 * kSide + rng.uniform(-0.5, 0.5);
  shape.height = rng.uniform(0.1, 0.4);
  return shape;
}

bool is_covered(const Shape& shape, double x, double y) {
  const double c = std::cos(shape.angle_rad);
  const double s = std::sin(shape.angle_rad);
  const double u = (x - shape.x_px) * c + (y - shape.y_px) * s;
  const double v = (y - shape.y_px) * c - (x - shape.x_px) * s;
  if (shape.kind == DefectKind::kHole) {
    return std::hypot(2.0 * u / shape.length_px, 2.0 * v / shape.width_px) < 1.0;
  }
  const double straight = 0.5 * (shape.length_px - shape.width_px);  // round ends
  return std::hypot(std::max(0.0, std::abs(u) - straight), v) < 0.5 * shape.width_px;
}

/// Shares of a pixel by 4 x 4 points, noise of one grey value of 255.
ImageF picture_of(const Shape& shape, Rng& rng) {
  ImageF aspect(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      int covered = 0;
      const double away_px = std::hypot(x + 0.5 - shape.x_px, y + 0.5 - shape.y_px);
      for (int i = 0; i < 16 && away_px < 0.5 * shape.length_px + 4.0; ++i) {
        const double px = x + 0.25 * (i % 4) + 0.125;
        const int row = i / 4;
        const double py = y + 0.25 * row + 0.125;
        covered += is_covered(shape, px, py) ? 1 : 0;
      }
      aspect(x, y) = static_cast<float>(0.5 + shape.height * covered / 16.0 + rng.normal() / 255.0);
    }
  }
  return aspect;
}

struct Tally {
  int right = 0;
  int shapes = 0;
  int pieces = 0;

  double share() const { return static_cast<double>(right) / shapes; }
};

/// A shape is what its blob of the largest weight is called.
Tally tally_of(const Inspector& inspector, int shapes) {
  ThreadPool pool(1);
  Tally tally;
  for (int i = 0; i < shapes; ++i) {
    Rng rng(51, Stream::kTest, static_cast<std::uint64_t>(i));
    const Shape shape = random_shape(rng, i % 2 == 0 ? DefectKind::kHole : DefectKind::kScratch);
    const Inspection found = inspector.inspect(picture_of(shape, rng), pool);
    const auto largest = std::ranges::max_element(found.defects, {}, &FoundDefect::weight);
    tally.right += largest != found.defects.end() && largest->kind == shape.kind ? 1 : 0;
    tally.pieces += static_cast<int>(found.defects.size());
    ++tally.shapes;
  }
  return tally;
}

InspectionSettings bright_settings() {
  // hole_below_px would call short scratches holes: here the shape alone decides.
  return {.polarity = InspectionSettings::Polarity::kBright, .hole_below_px = 0};
}

TEST(HoleOrScratch, IsRightForNearlyAllShapesOfAnyAngleAndSize) {
  const Inspector inspector(bright_settings(), Mask(kSide, kSide, 1));
  const Tally tally = tally_of(inspector, 1000);
  std::printf("hole or scratch: %.1f %% of %d right, %.2f blobs a shape\n",
              100.0 * tally.share(),
              tally.shapes,
              static_cast<double>(tally.pieces) / tally.shapes);
  EXPECT_GE(tally.share(), 0.98);
}

TEST(HoleOrScratch, IsRightForBothPolaritiesToo) {
  InspectionSettings settings = bright_settings();
  settings.polarity = InspectionSettings::Polarity::kBoth;
  EXPECT_GE(tally_of(Inspector(settings, Mask(kSide, kSide, 1)), 200).share(), 0.98);
}

TEST(HoleOrScratch, IsChanceByThePrintedRule) {
  InspectionSettings settings = bright_settings();
  settings.kind_rule = InspectionSettings::KindRule::kPrinted;
  const double share = tally_of(Inspector(settings, Mask(kSide, kSide, 1)), 200).share();
  std::printf("by the printed rule: %.1f %% right\n", 100.0 * share);
  EXPECT_LT(share, 0.65);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/larger_pixels.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

SceneSettings inspected() {
  SceneSettings scene;
  scene.metrics.defect_diameter_px = 9.0;
  scene.metrics.erosion_px = 3;
  scene.inspection.kernel_px = 11;
  scene.inspection.scales_px = {0.5, 4.0};
  scene.inspection.template_px = 5.0;
  scene.inspection.structure_px = 16.0;
  scene.inspection.erosion_px = 5;
  scene.inspection.min_area_px = 9;
  scene.inspection.hole_below_px = 12;
  scene.inspection.trials.echo_px = 12.0;
  scene.inspection.holes = {.perfect_biggest = 4.0,
                            .perfect_sum = 8.0,
                            .acceptable_biggest = 12.0,
                            .acceptable_sum = 16.0};
  scene.inspection.scratches.acceptable_sum = 20.0;
  scene.coverage.max_pixel_mm = 0.1;
  return scene;
}

TEST(WithLargerPixels, LengthsInPixelsStayTheSameOnThePart) {
  const SceneSettings half = with_larger_pixels(inspected(), 2);
  EXPECT_DOUBLE_EQ(half.metrics.defect_diameter_px, 4.5);
  EXPECT_EQ(half.metrics.erosion_px, 2);
  EXPECT_EQ(half.inspection.erosion_px, 3);
  EXPECT_DOUBLE_EQ(half.inspection.scales_px[0], 0.3) << "no less than the table allows";
  EXPECT_DOUBLE_EQ(half.inspection.scales_px[1], 2.0);
  EXPECT_DOUBLE_EQ(half.inspection.template_px, 2.5);
  EXPECT_DOUBLE_EQ(half.inspection.structure_px, 8.0);
  EXPECT_DOUBLE_EQ(half.inspection.trials.echo_px, 6.0);
  EXPECT_DOUBLE_EQ(half.coverage.max_pixel_mm, 0.2);
  EXPECT_DOUBLE_EQ(half.coverage.max_blur_px, 0.5);
  EXPECT_DOUBLE_EQ(half.coverage.defect_px, 1.5);
}

// 11 pixels: 5 on both sides, sigma 0.3 (5 - 1) + 0.8 = 2. Of half the pixels 3 on both sides.
TEST(WithLargerPixels, TheGaussianKeepsItsSigmaOnThePart) {
  const SceneSettings half = with_larger_pixels(inspected(), 2);
  EXPECT_EQ(half.inspection.kernel_px, 7);
  EXPECT_DOUBLE_EQ(half.inspection.sigma_px, 1.0);
  SceneSettings scene = inspected();
  scene.inspection.sigma_px = 3.0;
  scene.inspection.kernel_px = 3;
  EXPECT_DOUBLE_EQ(with_larger_pixels(scene, 4).inspection.sigma_px, 0.75);
  EXPECT_EQ(with_larger_pixels(scene, 4).inspection.kernel_px, 3);
}

// A blob of n large pixels has 4 n small ones: 4 n >= 9 where n >= 3, 4 n < 12 where n < 3.
TEST(WithLargerPixels, AreasShrinkByTheSquare) {
  const InspectionSettings half = with_larger_pixels(inspected(), 2).inspection;
  EXPECT_EQ(half.min_area_px, 3);
  EXPECT_EQ(half.hole_below_px, 3);
  EXPECT_DOUBLE_EQ(half.holes.perfect_biggest, 1.0);
  EXPECT_DOUBLE_EQ(half.holes.perfect_sum, 2.0);
  EXPECT_DOUBLE_EQ(half.holes.acceptable_biggest, 3.0);
  EXPECT_DOUBLE_EQ(half.holes.acceptable_sum, 4.0);
  EXPECT_DOUBLE_EQ(half.scratches.acceptable_sum, 5.0);
  EXPECT_EQ(with_larger_pixels(inspected(), 10).inspection.min_area_px, 1);
}

TEST(WithLargerPixels, OfFactorOneIsTheSceneItself) {
  const SceneSettings same = with_larger_pixels(inspected(), 1);
  EXPECT_EQ(same.inspection.sigma_px, 0.0);
  EXPECT_EQ(same.inspection.kernel_px, 11);
  EXPECT_EQ(same.metrics.defect_diameter_px, 9.0);
}

}  // namespace
}  // namespace glint

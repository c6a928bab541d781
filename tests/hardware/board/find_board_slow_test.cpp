// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well boards are found at full size, and how often. Each picture takes seconds to make.
#include <gtest/gtest.h>

#include "core/units.h"
#include "hardware/board/find_board.h"
#include "tests/hardware/board/board_scene.h"

namespace glint {
namespace {

const Board kBoard = {.cols = 10, .rows = 8, .square_mm = 6.6};

/// A camera of 2448 x 2050 pixels with a 12 mm lens, or smaller by a factor.
BoardScene scene_of(double size) {
  BoardScene scene = {.board = kBoard};
  scene.camera = {.width_px = static_cast<int>(2448 * size),
                  .height_px = static_cast<int>(2050 * size),
                  .focal_px = {3789.7 * size, 3791.0 * size},
                  .center_px = {1230.0 * size, 1020.0 * size},
                  .radial = {-0.1, 0.05, 0.0},
                  .tangential = {1e-3, -8e-4}};
  return scene;
}

/// Root mean square over all corners of views at full size whose largest blur lies in a range.
double rms_of(double least_blur_px, double most_blur_px, double noise, std::uint64_t seed) {
  constexpr int kViews = 50;
  Rng rng(seed, Stream::kTest, 0);
  double squares = 0.0;
  for (int i = 0; i < kViews;) {
    BoardScene scene = scene_of(1.0);
    scene.noise = noise;
    scene.camera_from_board =
        random_pose(kBoard, 146.0, 30 * kRadPerDeg, 40 * kRadPerDeg, 6.0, rng);
    const double slope = rng.uniform(0.05, most_blur_px / 12.0);
    scene.blur_px_at = [=](double depth) { return std::hypot(0.4, slope * (depth - 146.0)); };
    const double blur = largest_blur_px(scene);
    if (corners_inside_px(scene) < 30.0 || blur < least_blur_px || blur > most_blur_px) {
      continue;
    }
    ++i;
    const BoardView view = find_board(photographed(scene, rng), kBoard);
    EXPECT_TRUE(view.is_accepted()) << view.why;
    const double rms = rms_px(kBoard, view.picture_px, true_corners_px(scene));
    squares += rms * rms;
  }
  const double rms = std::sqrt(squares / kViews);
  std::cout << "blur " << least_blur_px << " to " << most_blur_px << " px, noise " << 255.0 * noise
            << ": rms " << rms << " px\n";
  return rms;
}

TEST(FindBoardStatistics, CornersAreExactToATwentiethOfAPixel) {
  EXPECT_LT(rms_of(0.0, 4.0, 2.0 / 255, 1), 0.05);
}

TEST(FindBoardStatistics, CornersAreExactToATenthWhereTheyAreBlurred) {
  EXPECT_LT(rms_of(4.0, 8.0, 2.0 / 255, 2), 0.1);
}

TEST(FindBoardStatistics, CornersAreExactUnderNoise) {
  EXPECT_LT(rms_of(0.0, 4.0, 8.0 / 255, 3), 0.07);
}

TEST(FindBoardStatistics, WholeBoardsAreFoundAndCutOnesAreNot) {
  constexpr int kBoards = 500;
  const double size = 0.25;
  Rng rng(4, Stream::kTest, 0);
  int num_whole = 0;
  int num_found = 0;
  int num_cut = 0;
  while (num_whole < kBoards || num_cut < kBoards) {
    BoardScene scene = scene_of(size);
    scene.camera_from_board =
        random_pose(kBoard, 150.0, 30 * kRadPerDeg, kPi, num_whole < kBoards ? 15.0 : 45.0, rng);
    const double slope = rng.uniform(0.0, 0.1);
    scene.blur_px_at = [=](double depth) { return std::hypot(0.4, slope * (depth - 146.0)); };
    scene.white = rng.uniform(0.4, 0.95);
    scene.shading = rng.uniform(0.0, 0.5);
    const double inside = corners_inside_px(scene);
    const double half_square_px = 0.5 * 171.0 * size;
    const bool is_whole = inside > 0.25 * half_square_px;
    const bool is_cut = inside <= -1.0 && inside >= -half_square_px;
    if ((!is_whole || num_whole == kBoards) && (!is_cut || num_cut == kBoards)) {
      continue;
    }
    const BoardView view = find_board(photographed(scene, rng), kBoard);
    if (is_whole) {
      ++num_whole;
      num_found += view.is_accepted() ? 1 : 0;
    } else {
      ++num_cut;
      EXPECT_FALSE(view.is_accepted()) << inside;
    }
  }
  std::cout << num_found << " of " << kBoards << " whole boards found\n";
  EXPECT_GE(num_found, 495);
}

}  // namespace
}  // namespace glint

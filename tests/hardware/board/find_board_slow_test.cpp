// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well boards are found at full size, and how often. Each picture takes seconds to make.
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>
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

/// Views whose largest blur lies in a range, and how exact their corners are to be.
struct Views {
  const char* name;
  double min_blur_px;
  double max_blur_px;
  double noise_codes;  ///< of 255
  double limit_px;
};

constexpr std::array<Views, 3> kViews = {{{"Sharp", 0.0, 4.0, 2.0, 0.05},
                                          {"Blurred", 4.0, 8.0, 2.0, 0.1},
                                          {"Noisy", 0.0, 4.0, 8.0, 0.07}}};
constexpr int kParts = 5;
constexpr int kViewsOfPart = 10;

/// A board at full size as the views have it.
BoardScene drawn_scene(const Views& views, Rng& rng) {
  while (true) {
    BoardScene scene = scene_of(1.0);
    scene.noise = views.noise_codes / 255.0;
    scene.camera_from_board =
        random_pose(kBoard, 146.0, 30 * kRadPerDeg, 40 * kRadPerDeg, 6.0, rng);
    const double slope = rng.uniform(0.05, views.max_blur_px / 12.0);
    scene.blur_px_at = [=](double depth) { return std::hypot(0.4, slope * (depth - 146.0)); };
    const double blur = largest_blur_px(scene);
    if (corners_inside_px(scene) >= 30.0 && blur >= views.min_blur_px &&
        blur <= views.max_blur_px) {
      return scene;
    }
  }
}

/// Fifty views of each kind, in five parts that can be run one by one.
class CornerStatistics : public testing::TestWithParam<std::tuple<Views, int>> {};

INSTANTIATE_TEST_SUITE_P(FindBoard,
                         CornerStatistics,
                         testing::Combine(testing::ValuesIn(kViews), testing::Range(0, kParts)),
                         [](const auto& one) {
                           return fmt::format(
                               "{}{}", std::get<0>(one.param).name, std::get<1>(one.param));
                         });

/// Mean squares of the parts that have run, added over the views of each.
std::map<std::string, std::vector<double>>& squares_of() {
  static std::map<std::string, std::vector<double>> squares;
  return squares;
}

TEST_P(CornerStatistics, AreNearlyAsExactAsAsked) {
  const auto& [views, part] = GetParam();
  double squares = 0.0;
  for (int i = 0; i < kViewsOfPart; ++i) {
    Rng rng(1, Stream::kTest, static_cast<std::uint64_t>(part * kViewsOfPart + i));
    const BoardScene scene = drawn_scene(views, rng);
    const BoardView view = find_board(photographed(scene, rng), kBoard);
    ASSERT_TRUE(view.is_accepted()) << view.why;
    squares += std::pow(rms_px(kBoard, view.picture_px, true_corners_px(scene)), 2);
  }
  const double rms = std::sqrt(squares / kViewsOfPart);
  fmt::print("{} part {}: rms {:.4f} px\n", views.name, part, rms);
  EXPECT_LT(rms, 1.25 * views.limit_px) << "ten views scatter more than fifty";
  squares_of()[views.name].push_back(squares);
}

class AllCorners : public testing::TestWithParam<Views> {};

INSTANTIATE_TEST_SUITE_P(FindBoard, AllCorners, testing::ValuesIn(kViews), [](const auto& one) {
  return std::string(one.param.name);
});

TEST_P(AllCorners, AreAsExactAsAsked) {
  const std::vector<double>& squares = squares_of()[GetParam().name];
  if (squares.size() != kParts) {
    GTEST_SKIP() << "not all parts ran before";
  }
  const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
  const double rms = std::sqrt(sum / (kParts * kViewsOfPart));
  fmt::print("{}: rms {:.4f} px over {} views\n", GetParam().name, rms, kParts * kViewsOfPart);
  EXPECT_LT(rms, GetParam().limit_px);
}

/// A whole board, or one that is cut by 1 px to half a square, at a quarter of the size.
class FoundBoards : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(FindBoard, FoundBoards, testing::Range(0, kParts));

BoardScene drawn_small_scene(bool is_whole, Rng& rng) {
  constexpr double kSize = 0.25;
  constexpr double kHalfSquare_px = 0.5 * 171.0 * kSize;
  while (true) {
    BoardScene scene = scene_of(kSize);
    scene.camera_from_board =
        random_pose(kBoard, 150.0, 30 * kRadPerDeg, kPi, is_whole ? 15.0 : 45.0, rng);
    const double slope = rng.uniform(0.0, 0.1);
    scene.blur_px_at = [=](double depth) { return std::hypot(0.4, slope * (depth - 146.0)); };
    scene.white = rng.uniform(0.4, 0.95);
    scene.shading = rng.uniform(0.0, 0.5);
    const double inside = corners_inside_px(scene);
    if (is_whole ? inside > 0.25 * kHalfSquare_px : inside <= -1.0 && inside >= -kHalfSquare_px) {
      return scene;
    }
  }
}

// Five hundred of each in all.
TEST_P(FoundBoards, AreTheWholeOnesAndNoCutOne) {
  constexpr int kBoards = 100;
  int num_found = 0;
  for (int i = 0; i < kBoards; ++i) {
    Rng rng(4, Stream::kTest, static_cast<std::uint64_t>(GetParam() * kBoards + i));
    const BoardScene whole = drawn_small_scene(true, rng);
    num_found += find_board(photographed(whole, rng), kBoard).is_accepted() ? 1 : 0;
    const BoardScene cut = drawn_small_scene(false, rng);
    EXPECT_FALSE(find_board(photographed(cut, rng), kBoard).is_accepted())
        << i << ": " << corners_inside_px(cut) << " px";
  }
  fmt::print("part {}: {} of {} whole boards found\n", GetParam(), num_found, kBoards);
  EXPECT_GE(num_found, 99);
}

}  // namespace
}  // namespace glint

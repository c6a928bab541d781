// SPDX-License-Identifier: GPL-3.0-or-later
//
// A checkerboard looked for in a picture of 5 megapixels, where it is and where it is not, by us
// and by OpenCV's classic search with and without its fast check.
#include <benchmark/benchmark.h>
#include <opencv2/calib3d.hpp>

#include "hardware/board/find_board.h"
#include "tests/hardware/board/board_scene.h"

namespace glint {
namespace {

const Board kBoard = {.cols = 10, .rows = 8, .square_mm = 6.6};

Image<std::uint8_t> make_picture(bool has_board) {
  BoardScene scene = {.board = kBoard};
  scene.camera = {.width_px = 2448,
                  .height_px = 2050,
                  .focal_px = {3789.7, 3791.0},
                  .center_px = {1230.0, 1020.0},
                  .radial = {-0.1, 0.05, 0.0},
                  .tangential = {1e-3, -8e-4}};
  scene.blur_px_at = [](double depth) { return std::hypot(0.4, 0.15 * (depth - 146.0)); };
  Rng rng(1, Stream::kTest, 0);
  scene.camera_from_board = has_board
                                ? random_pose(kBoard, 146.0, 0.4, 0.5, 3.0, rng)
                                : Eigen::Isometry3d(Eigen::Translation3d(1000.0, 1000.0, 146.0));
  return photographed(scene, rng);
}

const Image<std::uint8_t>& picture(bool has_board) {
  static const Image<std::uint8_t> with = make_picture(true);
  static const Image<std::uint8_t> without = make_picture(false);
  return has_board ? with : without;
}

void find_by_us(benchmark::State& state, bool has_board) {
  const Pixels pixels = picture(has_board);
  for (auto _ : state) {
    const BoardView view = find_board(pixels, kBoard);
    if (view.is_accepted() != has_board) {
      state.SkipWithError("wrong outcome");
    }
  }
}

void find_by_opencv(benchmark::State& state, bool has_board, int more_flags) {
  cv::setNumThreads(1);
  Image<std::uint8_t> copy = picture(has_board);
  const cv::Mat image(copy.height(), copy.width(), CV_8UC1, copy.row(0));
  const int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | more_flags;
  for (auto _ : state) {
    std::vector<cv::Point2f> corners;
    const bool is_found =
        cv::findChessboardCorners(image, {kBoard.cols, kBoard.rows}, corners, flags);
    benchmark::DoNotOptimize(is_found);
  }
}

BENCHMARK_CAPTURE(find_by_us, board, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find_by_opencv, board_fast_check, true, cv::CALIB_CB_FAST_CHECK)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find_by_us, no_board, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find_by_opencv, no_board_classic, false, 0)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace glint

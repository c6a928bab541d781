// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs by others: corners found by us and by OpenCV with several windows, judged by how well
// a camera from all other pictures predicts those of each.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "hardware/board/find_board.h"
#include "hardware/calibration_review/prediction.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(GLINT_SHARED_DIR) / "data/calibration/chessboard_left";

/// The photographs, all of 8 bits and one size.
std::vector<Image<std::uint8_t>> read_photographs() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    if (entry.path().extension() == ".jpg") {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  std::vector<Image<std::uint8_t>> photographs;
  for (const fs::path& file : files) {
    photographs.push_back(std::get<Image<std::uint8_t>>(read_picture(file).pixels));
  }
  return photographs;
}

BoardCorners corners_by_us(const Image<std::uint8_t>& photograph, const Board& board) {
  const BoardView view = find_board(photograph, board);
  EXPECT_TRUE(view.is_accepted()) << view.why;
  return {.board_mm = view.board_mm, .picture_px = view.picture_px};
}

/// Median distance of neighbours in a row.
double square_px(const std::vector<cv::Point2f>& corners, int cols) {
  std::vector<double> lengths;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (i % static_cast<std::size_t>(cols) != 0) {
      lengths.push_back(cv::norm(corners[i] - corners[i - 1]));
    }
  }
  std::ranges::sort(lengths);
  return lengths[lengths.size() / 2];
}

/// @param half_px  OpenCV's winSize; 0: a quarter of a square
BoardCorners corners_by_opencv(Image<std::uint8_t> photograph, const Board& board, int half_px) {
  const cv::Mat image(photograph.height(), photograph.width(), CV_8UC1, photograph.row(0));
  std::vector<cv::Point2f> found;
  BoardCorners corners;
  if (!cv::findChessboardCorners(image, {board.cols, board.rows}, found)) {
    ADD_FAILURE() << "OpenCV finds no board";
    return corners;
  }
  const int half =
      half_px > 0 ? half_px
                  : std::max(1, static_cast<int>(std::lround(square_px(found, board.cols) / 4)));
  const cv::TermCriteria enough(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 100, 1e-4);
  cv::cornerSubPix(image, found, {half, half}, {-1, -1}, enough);
  for (int i = 0; i < board.cols * board.rows; ++i) {
    const cv::Point2f& at = found[static_cast<std::size_t>(i)];
    const int row = i / board.cols;
    corners.board_mm.emplace_back(board.square_mm * (i % board.cols), board.square_mm * row, 0.0);
    // Its first pixel's middle is (0, 0).
    corners.picture_px.emplace_back(static_cast<double>(at.x) + 0.5,
                                    static_cast<double>(at.y) + 0.5);
  }
  return corners;
}

double left_out_rms_px(const std::vector<BoardCorners>& pictures, int width_px, int height_px) {
  const CameraOptions options = {.width_px = width_px, .height_px = height_px};
  const CameraCalibration camera = calibrate_camera(pictures, options);
  EXPECT_TRUE(camera.succeeded) << camera.refusal;
  for (const CalibratedPicture& picture : camera.pictures) {
    EXPECT_TRUE(picture.accepted) << picture.reason;
  }
  ThreadPool pool(2);
  const std::vector<int> folds = leave_one_out(static_cast<int>(pictures.size()));
  return predict_camera_left_out(pictures, camera.lens, options, folds, pool).rms_px;
}

TEST(CornerWindows, OursPredictTheChessboardNoWorseThanOpenCvsBest) {
  if (!fs::exists(kFolder)) {
    GTEST_SKIP() << "no " << kFolder;
  }
  const Board board = read_board(kFolder / "board.json");
  const std::vector<Image<std::uint8_t>> photographs = read_photographs();
  ASSERT_EQ(photographs.size(), 13u);
  std::vector<BoardCorners> own;
  std::map<int, std::vector<BoardCorners>> theirs;
  for (const Image<std::uint8_t>& photograph : photographs) {
    own.push_back(corners_by_us(photograph, board));
    for (const int half : {3, 5, 7, 0}) {
      theirs[half].push_back(corners_by_opencv(photograph, board, half));
    }
  }
  const double own_px = left_out_rms_px(own, photographs[0].width(), photographs[0].height());
  RecordProperty("own_px", std::to_string(own_px));
  for (const auto& [half, corners] : theirs) {
    const double px = left_out_rms_px(corners, photographs[0].width(), photographs[0].height());
    RecordProperty("opencv_" + std::to_string(half) + "_px", std::to_string(px));
    EXPECT_LE(own_px, px) << "window " << half;
  }
}

}  // namespace
}  // namespace glint

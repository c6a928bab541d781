// SPDX-License-Identifier: GPL-3.0-or-later
//
// Nineteen photographs of a checkerboard held by a robot: rendered with the calibration that they
// give, the edges of its squares lie on the photographed ones.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "core/image/image_io.h"
#include "hardware/board/find_board.h"
#include "hardware/calibration/camera_calibration.h"
#include "metrics/overlap/boundary_distance.h"
#include "metrics/overlap/ring_offsets.h"
#include "studies/compare/outlines.h"
#include "tests/hardware/board/board_scene.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

const fs::path kBoardFolder = fs::path(GLINT_SHARED_DIR) / "data/calibration/board_on_robot";

struct PhotographedBoard {
  Board board;
  std::vector<ImageF> pictures;
  std::vector<BoardView> views;
  CameraCalibration camera;
};

PhotographedBoard read_photographs() {
  PhotographedBoard result = {.board = read_board(kBoardFolder / "board.json")};
  std::vector<BoardCorners> corners;
  for (int i = 0; i < 20; ++i) {
    const fs::path file = kBoardFolder / fmt::format("img{:02d}.png", i);
    if (!fs::exists(file)) {
      continue;
    }
    const Picture picture = read_picture(file);
    const BoardView view = find_board(picture.pixels, result.board);
    result.pictures.push_back(linear_values(picture.pixels));
    result.views.push_back(view);
    corners.push_back(view.is_accepted()
                          ? BoardCorners{.board_mm = view.board_mm, .picture_px = view.picture_px}
                          : BoardCorners{});
  }
  result.camera = calibrate_camera(
      corners,
      {.width_px = result.pictures.front().width(), .height_px = result.pictures.front().height()});
  return result;
}

ComparedPicture as_compared(const ImageF& grey) {
  return {.source = {.name = "picture"}, .grey = grey};
}

/// The board as the calibration says that it is seen.
ImageF rendered(const PhotographedBoard& photographs, std::size_t index) {
  BoardScene scene = {.board = photographs.board, .camera = photographs.camera.intrinsics()};
  scene.camera_from_board = photographs.camera.pictures[index].camera_from_board;
  scene.has_clutter = false;
  scene.noise = 0.0;
  scene.shading = 0.0;
  Rng rng(1, Stream::kTest, index);
  return linear_values(photographed(scene, rng));
}

TEST(RealBoard, EdgesOfRenderedSquaresLieOnThePhotographedOnes) {
  if (!fs::exists(kBoardFolder / "board.json")) {
    GTEST_SKIP() << kBoardFolder << " is not there";
  }
  const PhotographedBoard photographs = read_photographs();
  ASSERT_TRUE(photographs.camera.succeeded) << photographs.camera.refusal;
  double sum = 0.0;
  double points = 0.0;
  int compared = 0;
  std::vector<EdgeOffset> offsets;
  for (std::size_t i = 0; i < photographs.views.size(); ++i) {
    if (!photographs.camera.pictures[i].accepted) {
      continue;
    }
    const OutlinePair outlines = find_outlines(as_compared(rendered(photographs, i)),
                                               as_compared(photographs.pictures[i]),
                                               {},
                                               OutlineChoice::kInner);
    const auto& simulated = outlines.simulated.located;
    const auto& real = outlines.real.located;
    const BoundaryDistance distance = boundary_distance(simulated, real);
    ASSERT_GT(distance.points, 1000U) << i;
    EXPECT_LT(distance.mean_px, 1.0) << i;
    sum += distance.mean_px * static_cast<double>(distance.points);
    points += static_cast<double>(distance.points);
    ++compared;
    for (const BoundaryGap& gap : gaps_between(simulated, real)) {
      offsets.push_back(
          {.at_px = gap.from.at_px, .normal = gap.from.normal, .offset_px = gap.offset_px});
    }
  }
  EXPECT_GE(compared, 15);
  RecordProperty("mean_px", fmt::format("{:.3f}", sum / points));
  EXPECT_LE(sum / points, 0.35);
  const RingOffsets rings = ring_offsets(offsets, {960.0, 600.0});
  ASSERT_TRUE(rings.has_slopes);
  RecordProperty("radial_slope", fmt::format("{:.3f}", rings.radial_slope.value));
  RecordProperty("tangential_slope", fmt::format("{:.3f}", rings.tangential_slope.value));
  EXPECT_LT(std::abs(rings.radial_slope.value), 0.5);
  EXPECT_LT(std::abs(rings.tangential_slope.value), 0.5);
}

}  // namespace
}  // namespace glint

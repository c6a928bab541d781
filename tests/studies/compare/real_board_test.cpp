// SPDX-License-Identifier: GPL-3.0-or-later
//
// Nineteen photographs of a checkerboard held by a robot: rendered with the calibration that they
// give, the edges of its squares lie on the photographed ones.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>
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
  std::vector<BoardCorners> corners;  ///< none where no board was found
  CameraCalibration camera;
};

/// @param terms  of the lens; not given: chosen by held-out prediction
CameraCalibration calibrated(const PhotographedBoard& photographs,
                             const std::optional<LensMask>& terms) {
  return calibrate_camera(photographs.corners,
                          {.width_px = photographs.pictures.front().width(),
                           .height_px = photographs.pictures.front().height(),
                           .free_terms = terms});
}

void add_picture(PhotographedBoard& photographs, const Pixels& pixels) {
  const BoardView view = find_board(pixels, photographs.board);
  photographs.pictures.push_back(linear_values(pixels));
  photographs.corners.push_back(
      view.is_accepted() ? BoardCorners{.board_mm = view.board_mm, .picture_px = view.picture_px}
                         : BoardCorners{});
}

/// The first square of a board is dark: seen that way this one has its long side along y. The other
/// way all squares would be rendered in the wrong colour.
PhotographedBoard read_photographs() {
  PhotographedBoard result = {.board = read_board(kBoardFolder / "board.json")};
  if (result.board.cols > result.board.rows) {
    std::swap(result.board.cols, result.board.rows);
  }
  for (int i = 0; i < 20; ++i) {
    const fs::path file = kBoardFolder / fmt::format("img{:02d}.png", i);
    if (fs::exists(file)) {
      add_picture(result, read_picture(file).pixels);
    }
  }
  result.camera = calibrated(result, std::nullopt);
  return result;
}

ComparedPicture as_compared(const ImageF& grey) {
  return {.source = {.name = "picture"}, .grey = grey};
}

/// The board as a camera sees it, without noise.
BoardScene scene_of(const PhotographedBoard& photographs, std::size_t index) {
  BoardScene scene = {.board = photographs.board, .camera = photographs.camera.intrinsics()};
  scene.camera_from_board = photographs.camera.pictures[index].camera_from_board;
  scene.has_clutter = false;
  scene.noise = 0.0;
  scene.shading = 0.0;
  return scene;
}

/// Edges of the board as the calibration says that it is seen, beside the pictured ones.
struct BoardEdges {
  std::vector<EdgeOffset> offsets;
  double sum_px = 0.0;
  double points = 0.0;
  double share = 0.0;  ///< of edges on either side with a counterpart, summed over the pictures
  int compared = 0;

  double mean_px() const { return sum_px / points; }
};

BoardEdges edges_of(const PhotographedBoard& photographs) {
  BoardEdges edges;
  for (std::size_t i = 0; i < photographs.pictures.size(); ++i) {
    if (!photographs.camera.pictures[i].accepted) {
      continue;
    }
    Rng rng(1, Stream::kTest, i);
    const ImageF rendered = linear_values(photographed(scene_of(photographs, i), rng));
    const OutlinePair outlines = find_outlines(
        as_compared(rendered), as_compared(photographs.pictures[i]), {}, OutlineChoice::kInner);
    const auto& simulated = outlines.simulated.located;
    const auto& real = outlines.real.located;
    const BoundaryDistance distance = boundary_distance(simulated, real);
    EXPECT_GT(distance.points, 1000U) << i;
    EXPECT_LT(distance.mean_px, 3.0) << i;
    edges.sum_px += distance.mean_px * static_cast<double>(distance.points);
    edges.points += static_cast<double>(distance.points);
    edges.share += distance.share;
    ++edges.compared;
    for (const BoundaryGap& gap : gaps_between(simulated, real)) {
      edges.offsets.push_back(
          {.at_px = gap.from.at_px, .normal = gap.from.normal, .offset_px = gap.offset_px});
    }
  }
  return edges;
}

TEST(RealBoard, EdgesOfRenderedSquaresLieOnThePhotographedOnes) {
  if (!fs::exists(kBoardFolder / "board.json")) {
    GTEST_SKIP() << kBoardFolder << " is not there";
  }
  const PhotographedBoard photographs = read_photographs();
  ASSERT_TRUE(photographs.camera.succeeded) << photographs.camera.refusal;
  const BoardEdges edges = edges_of(photographs);
  EXPECT_GE(edges.compared, 15);
  RecordProperty("mean_px", fmt::format("{:.3f}", edges.mean_px()));
  const double share = edges.share / edges.compared;
  std::printf("%d pictures, %.3f px, %.1f %% of the edges\n",
              edges.compared,
              edges.mean_px(),
              100.0 * share);
  EXPECT_GE(share, 0.8);
  EXPECT_LE(edges.mean_px(), 0.35);
  const RingOffsets rings = ring_offsets(edges.offsets, {960.0, 600.0});
  ASSERT_TRUE(rings.radial_slope && rings.tangential_slope);
  std::printf("slopes: radial %.3f, tangential %.3f px per 1000 px\n",
              rings.radial_slope->value,
              rings.tangential_slope->value);
  RecordProperty("radial_slope", fmt::format("{:.3f}", rings.radial_slope->value));
  RecordProperty("tangential_slope", fmt::format("{:.3f}", rings.tangential_slope->value));
  EXPECT_LT(std::abs(rings.radial_slope->value), 0.5);
  EXPECT_LT(std::abs(rings.tangential_slope->value), 0.5);
}

/// The larger of both ring slopes over its standard deviation.
double slope_sigmas(const BoardEdges& edges) {
  const RingOffsets rings = ring_offsets(edges.offsets, {960.0, 600.0});
  EXPECT_TRUE(rings.radial_slope && rings.tangential_slope);
  double most = 0.0;
  for (const std::optional<Estimate>& slope : {rings.radial_slope, rings.tangential_slope}) {
    if (slope) {
      const double sigma = (slope->high - slope->low) / (2.0 * 1.96);
      std::printf("slope %.4f +- %.4f px per 1000 px\n", slope->value, sigma);
      most = std::max(most, std::abs(slope->value) / sigma);
    }
  }
  return most;
}

// The same boards at the same places before a lens whose axis is tilted: rendered without p1 edges
// leave a slope, rendered with it they do not. (Poses that are fitted to each picture would take
// most of it: 0.0062 +- 0.0052 px per 1000 px is left.)
TEST(BoardTwin, RingSlopesShowThatTheLensModelLacksTangentialTerms) {
  if (!fs::exists(kBoardFolder / "board.json")) {
    GTEST_SKIP() << kBoardFolder << " is not there";
  }
  PhotographedBoard photographs = read_photographs();
  PhotographedBoard twin = {.board = photographs.board, .camera = photographs.camera};
  for (std::size_t i = 0; i < photographs.pictures.size(); ++i) {
    // Every other picture: the rest of them tells no more.
    CalibratedPicture& picture = twin.camera.pictures[i];
    picture.accepted = picture.accepted && i % 2 == 0;
    if (!picture.accepted) {
      twin.pictures.emplace_back();
      continue;
    }
    BoardScene scene = scene_of(photographs, i);
    scene.camera.tangential[0] += 1e-3;
    scene.noise = 2.0 / 255.0;
    Rng rng(5, Stream::kTest, i);
    twin.pictures.push_back(linear_values(Pixels(photographed(scene, rng))));
  }
  const BoardEdges radial = edges_of(twin);
  EXPECT_GE(slope_sigmas(radial), 3.0);
  constexpr Eigen::Index kP1 = 7;
  twin.camera.lens[kP1] += 1e-3;
  const BoardEdges full = edges_of(twin);
  EXPECT_LT(slope_sigmas(full), 2.0);
  EXPECT_LT(full.mean_px(), radial.mean_px());
}

}  // namespace
}  // namespace glint

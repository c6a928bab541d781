// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/find_board.h"

#include <gmock/gmock.h>

#include "core/units.h"
#include "hardware/board/charuco.h"
#include "tests/hardware/board/board_scene.h"

namespace glint {
namespace {

using testing::HasSubstr;

/// A quarter of the width and height of a camera with 5 megapixels.
BoardScene small_scene(const Board& board) {
  BoardScene scene = {.board = board};
  scene.camera = {.width_px = 612,
                  .height_px = 512,
                  .focal_px = {947.0, 948.0},
                  .center_px = {307.5, 255.0},
                  .radial = {-0.1, 0.05, 0.0},
                  .tangential = {1e-3, -8e-4}};
  return scene;
}

BoardView view_of(const BoardScene& scene, std::uint64_t seed) {
  Rng rng(seed, Stream::kTest, 1);
  return find_board(photographed(scene, rng), scene.board);
}

const Board kBoard = {.cols = 10, .rows = 8, .square_mm = 6.6};

TEST(FindBoard, PlacesCornersToAFewHundredthsOfAPixel) {
  Rng rng(1, Stream::kTest, 0);
  double squares = 0.0;
  constexpr int kViews = 6;
  for (int i = 0; i < kViews; ++i) {
    BoardScene scene = small_scene(kBoard);
    scene.camera_from_board = random_pose(kBoard, 175.0, 25 * kRadPerDeg, 0.6, 3.0, rng);
    scene.blur_px_at = [&](double depth) { return 0.4 + 0.06 * std::abs(depth - 175.0); };
    const BoardView view = view_of(scene, static_cast<std::uint64_t>(i));
    ASSERT_TRUE(view.is_accepted()) << view.why;
    const double rms = rms_px(kBoard, view.picture_px, true_corners_px(scene));
    squares += rms * rms;
    EXPECT_GT(view.noise, 1.5 / 255.0);
    EXPECT_LT(view.noise, 5.0 / 255.0);  // what the model lacks is in it
    EXPECT_NEAR(*std::ranges::max_element(view.blur_px), largest_blur_px(scene), 0.5);
  }
  EXPECT_LT(std::sqrt(squares / kViews), 0.05);
}

TEST(FindBoard, KnowsTheFirstCornerByColoursOrMark) {
  const Board odd = {.cols = 9, .rows = 6, .square_mm = 7.0};
  const Board marked = {.cols = 8, .rows = 6, .square_mm = 7.0, .mark = true};
  const Board plain = {.cols = 8, .rows = 6, .square_mm = 7.0};
  Rng rng(2, Stream::kTest, 0);
  for (const double roll : {0.3, 0.3 + kPi / 2, 0.3 + kPi}) {
    for (const Board& board : {odd, marked, plain}) {
      BoardScene scene = small_scene(board);
      scene.camera_from_board = random_pose(board, 170.0, 0.3, 0.0, 2.0, rng);
      scene.camera_from_board =
          scene.camera_from_board *
          Eigen::Translation3d(corner_mm(board, board.cols - 1, board.rows - 1) / 2) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) *
          Eigen::Translation3d(-corner_mm(board, board.cols - 1, board.rows - 1) / 2);
      const BoardView view = view_of(scene, 3);
      ASSERT_TRUE(view.is_accepted()) << view.why;
      EXPECT_EQ(view.is_orientation_known, num_symmetries(board) == 1);
      EXPECT_LT(rms_px(board, view.picture_px, true_corners_px(scene)), 0.1);
    }
  }
}

TEST(FindBoard, RejectsABoardThatIsCutOff) {
  Rng rng(3, Stream::kTest, 0);
  int num_cut = 0;
  for (int i = 0; num_cut < 8; ++i) {
    BoardScene scene = small_scene(kBoard);
    scene.camera_from_board = random_pose(kBoard, 150.0, 0.3, 0.6, 40.0, rng);
    const double inside = corners_inside_px(scene);
    if (inside > -1.0 || inside < -21.0) {  // 1 px to half a square
      continue;
    }
    ++num_cut;
    const BoardView view = view_of(scene, static_cast<std::uint64_t>(i));
    EXPECT_EQ(view.outcome, BoardOutcome::kCutOff) << view.why << inside;
    EXPECT_TRUE(view.picture_px.empty());
  }
}

TEST(FindBoard, TellsWhyAPictureIsOfNoUse) {
  Rng rng(4, Stream::kTest, 0);
  BoardScene scene = small_scene(kBoard);
  scene.camera_from_board = random_pose(kBoard, 150.0, 0.2, 0.2, 2.0, rng);
  ASSERT_TRUE(view_of(scene, 5).is_accepted());

  BoardScene blurred = scene;
  blurred.blur_px_at = [](double) { return 11.0; };  // of squares of 41 px
  EXPECT_EQ(view_of(blurred, 5).outcome, BoardOutcome::kBlurred) << view_of(blurred, 5).why;

  BoardScene dark = scene;
  dark.white = 0.04;
  dark.black = 0.01;
  dark.has_clutter = false;
  EXPECT_EQ(view_of(dark, 5).outcome, BoardOutcome::kDark) << view_of(dark, 5).why;

  BoardScene bright = scene;
  bright.white = 3.0;
  bright.black = 1.5;
  bright.has_clutter = false;
  EXPECT_EQ(view_of(bright, 5).outcome, BoardOutcome::kSaturated) << view_of(bright, 5).why;

  const BoardView other = find_board(photographed(scene, rng), {.cols = 8, .rows = 8});
  EXPECT_EQ(other.outcome, BoardOutcome::kNoBoard);
  EXPECT_THAT(other.why, HasSubstr("a grid of 80 corners, the board has 8 x 8"));
  const BoardView larger = find_board(photographed(scene, rng), {.cols = 12, .rows = 8});
  EXPECT_EQ(larger.outcome, BoardOutcome::kNoBoard);
  EXPECT_THAT(larger.why, HasSubstr("80 of 96 corners were found"));
}

TEST(FindBoard, RejectsASpotOfLightOnCorners) {
  Rng rng(5, Stream::kTest, 0);
  BoardScene scene = small_scene(kBoard);
  scene.camera_from_board = random_pose(kBoard, 150.0, 0.2, 0.2, 2.0, rng);
  Image<std::uint8_t> picture = photographed(scene, rng);
  const Eigen::Vector2d spot = true_corners_px(scene)[44];
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const double r2 = (Eigen::Vector2d(x + 0.5, y + 0.5) - spot).squaredNorm();
      const double grey = picture(x, y) + 900.0 * std::exp(-r2 / (2.0 * 25.0 * 25.0));
      picture(x, y) = static_cast<std::uint8_t>(std::min(grey, 255.0));
    }
  }
  const BoardView view = find_board(picture, kBoard);
  EXPECT_EQ(view.outcome, BoardOutcome::kSaturated) << view.why;
}

TEST(FindBoard, FindsNoBoardWhereThereIsNone) {
  Rng rng(6, Stream::kTest, 0);
  Image<std::uint8_t> noise(640, 480);
  for (std::uint8_t& value : noise.values()) {
    value = static_cast<std::uint8_t>(rng.uniform(0.0, 256.0));
  }
  EXPECT_EQ(find_board(noise, kBoard).outcome, BoardOutcome::kNoBoard);
  EXPECT_EQ(find_board(Image<std::uint8_t>(640, 480, 128), kBoard).outcome, BoardOutcome::kNoBoard);
  EXPECT_EQ(find_board(Image<std::uint8_t>(20, 20, 128), kBoard).outcome, BoardOutcome::kNoBoard);
  EXPECT_EQ(find_board(Image<std::uint8_t>(640, 480, 3), kBoard).outcome, BoardOutcome::kDark);
  EXPECT_EQ(find_board(Image<std::uint8_t>(640, 480, 255), kBoard).outcome,
            BoardOutcome::kSaturated);
}

TEST(FindBoard, SaysOfCharucoThatThereIsNoneForWantOrExcessOfLight) {
  const Board markers = {.kind = BoardKind::kCharuco, .cols = 6, .rows = 4, .square_mm = 20.0};
  EXPECT_EQ(find_board(Image<std::uint8_t>(640, 480, 3), markers).outcome, BoardOutcome::kDark);
  EXPECT_EQ(find_board(Image<std::uint8_t>(640, 480, 255), markers).outcome,
            BoardOutcome::kSaturated);
  const BoardView grey = find_board(Image<std::uint8_t>(640, 480, 128), markers);
  EXPECT_EQ(grey.outcome, BoardOutcome::kNoBoard);
  EXPECT_EQ(grey.why, "no marker of the board was found");
}

TEST(FindBoard, GivesTheSameCornersFor8And16Bits) {
  Rng rng(7, Stream::kTest, 0);
  BoardScene scene = small_scene(kBoard);
  scene.camera_from_board = random_pose(kBoard, 150.0, 0.2, 0.2, 2.0, rng);
  const Image<std::uint8_t> picture = photographed(scene, rng);
  Image<std::uint16_t> deep(picture.width(), picture.height());
  std::ranges::transform(picture.values(), deep.values().begin(), [](std::uint8_t code) {
    return static_cast<std::uint16_t>(257 * code);
  });
  const BoardView a = find_board(picture, kBoard);
  const BoardView b = find_board(deep, kBoard);
  ASSERT_EQ(a.picture_px.size(), b.picture_px.size());
  for (std::size_t i = 0; i < a.picture_px.size(); ++i) {
    EXPECT_LT((a.picture_px[i] - b.picture_px[i]).norm(), 1e-3);
  }
}

TEST(FindBoard, FindsPartsOfACharucoBoard) {
  const Board board = {.kind = BoardKind::kCharuco, .cols = 6, .rows = 5, .square_mm = 12.0};
  Rng rng(8, Stream::kTest, 0);
  BoardScene scene = small_scene(board);
  scene.camera_from_board = random_pose(board, 230.0, 0.3, 0.6, 2.0, rng);
  const BoardView whole = view_of(scene, 9);
  ASSERT_TRUE(whole.is_accepted()) << whole.why;
  ASSERT_EQ(whole.picture_px.size(), 30U);
  EXPECT_LT(rms_px(board, whole.picture_px, true_corners_px(scene)), 0.06);

  scene.camera_from_board.translation().x() += 60.0;
  const BoardView part = view_of(scene, 9);
  ASSERT_TRUE(part.is_accepted()) << part.why;
  EXPECT_LT(part.picture_px.size(), 30U);
  const PinholeCamera camera(scene.camera);
  for (std::size_t i = 0; i < part.picture_px.size(); ++i) {
    const auto truth = camera.project(scene.camera_from_board * part.board_mm[i]);
    EXPECT_LT((part.picture_px[i] - truth.value()).norm(), 0.2);
  }
  scene.camera_from_board.translation().x() += 200.0;
  EXPECT_EQ(view_of(scene, 9).outcome, BoardOutcome::kNoBoard);
}

/// Squares of 20 px seen from the front, the first corner at (60, 60).
/// @param first  0: the first square is dark, 1: it is white
Image<std::uint8_t> printed_charuco(const Board& board, int first) {
  constexpr int kSquare = 20;
  Image<std::uint8_t> picture(
      kSquare * (board.cols + 5), kSquare * (board.rows + 5), std::uint8_t{230});
  const auto fill = [&](int x0, int y0, int side, std::uint8_t grey) {
    for (int y = y0; y < y0 + side; ++y) {
      std::fill_n(picture.row(y) + x0, side, grey);
    }
  };
  const std::vector<CharucoMarker> markers = charuco_markers(board);
  std::size_t next = 0;
  for (int row = 0; row <= board.rows; ++row) {
    for (int col = 0; col <= board.cols; ++col) {
      const int x0 = kSquare * (col + 2);
      const int y0 = kSquare * (row + 2);
      if ((row + col) % 2 == first) {
        fill(x0, y0, kSquare, 20);
        continue;
      }
      const CharucoMarker& marker = markers[next++];
      for (std::size_t i = 0; i < marker.is_dark.size(); ++i) {
        const auto side = static_cast<std::size_t>(marker.side);
        fill(x0 + 4 + 2 * static_cast<int>(i % side),
             y0 + 4 + 2 * static_cast<int>(i / side),
             2,
             marker.is_dark[i] ? 20 : 230);
      }
    }
  }
  return picture;
}

TEST(FindBoard, FindsCharucoBoardsThatBeginWithAWhiteSquare) {
  // 6 x 6 squares, markers of 6 modules of 2 px.
  const Board even = {
      .kind = BoardKind::kCharuco, .cols = 5, .rows = 5, .square_mm = 10.0, .marker_mm = 6.0};
  for (const int first : {0, 1}) {
    const BoardView view = find_board(printed_charuco(even, first), even);
    ASSERT_TRUE(view.is_accepted()) << first << ' ' << view.why;
    ASSERT_EQ(view.picture_px.size(), 25U) << first;
    for (std::size_t i = 0; i < view.picture_px.size(); ++i) {
      const Eigen::Vector2d truth = 2.0 * view.board_mm[i].head<2>() + Eigen::Vector2d(60.0, 60.0);
      EXPECT_LT((view.picture_px[i] - truth).norm(), 0.05) << first << ' ' << i;
    }
  }
  // Nobody printed boards of odd numbers of rows so.
  Board odd = even;
  odd.rows = 4;
  EXPECT_TRUE(find_board(printed_charuco(odd, 0), odd).is_accepted());
  EXPECT_FALSE(find_board(printed_charuco(odd, 1), odd).is_accepted());
}

}  // namespace
}  // namespace glint

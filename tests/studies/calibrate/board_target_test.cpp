// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/board_target.h"

#include <gtest/gtest.h>

#include "hardware/board/board_sheet.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const Board kMarked = {.cols = 5, .rows = 4, .square_mm = 10.0, .mark = true};

/// What the sheet returns at a point of the board, by the way a renderer takes: over the part's
/// frame and the texture's mapping.
float ink_at(const Board& board, const ImageF& ink, double squares_x, double squares_y) {
  const BoardTarget target = board_target(board, "ink.png", 0.8);
  const Vector3d on_part =
      target.part_from_board * (board.square_mm * Vector3d(squares_x, squares_y, 0.0));
  const Vector2d repeat = TextureMapping(target.material.texture).at(on_part);
  return ink(static_cast<int>(repeat.x() * ink.width()),
             static_cast<int>(repeat.y() * ink.height()));
}

// The first square, beside corner (0, 0), is dark with a white dot of 0.4 squares in its middle.
TEST(BoardTarget, HasItsInkWhereTheBoardHasIt) {
  const ImageF ink = ink_picture(kMarked, 0.05);
  EXPECT_EQ(ink_at(kMarked, ink, -0.5, -0.5), 1.0F) << "the mark";
  EXPECT_EQ(ink_at(kMarked, ink, -0.9, -0.9), 0.05F);
  EXPECT_EQ(ink_at(kMarked, ink, 0.5, -0.5), 1.0F);
  EXPECT_EQ(ink_at(kMarked, ink, 0.5, 0.5), 0.05F);
  // Squares (cols + 1) x (rows + 1) = 6 x 5: that of the last column and row is (5 + 4) odd, white.
  EXPECT_EQ(ink_at(kMarked, ink, 4.5, 3.5), 1.0F);
  EXPECT_EQ(ink_at(kMarked, ink, 3.5, 3.5), 0.05F);
  EXPECT_EQ(ink_at(kMarked, ink, -1.2, 1.0), 1.0F) << "the border";
}

// Edges between squares lie between two points of the picture, or it would move corners.
TEST(BoardTarget, EdgesLieBetweenPoints) {
  const ImageF ink = ink_picture(kMarked, 0.0);
  const BoardSheet sheet = board_sheet(kMarked);
  const double texel_mm = kMarked.square_mm / kTexelsPerSquare;
  const double edge = sheet.first_corner_mm.x() / texel_mm;
  EXPECT_NEAR(edge, std::round(edge), 1e-9);
  const int x = static_cast<int>(std::lround(edge));
  const int y = static_cast<int>(std::lround(sheet.first_corner_mm.y() / texel_mm)) - 5;
  EXPECT_EQ(ink(x - 1, y), 0.0F);
  EXPECT_EQ(ink(x, y), 1.0F);
}

// The border of 10 mm and squares of 6.6 mm: 16.6 mm are 402.42 points of 0.04125 mm, the ink
// begins at 402. A sheet's corner that is taken for it is off by 0.0175 mm.
TEST(BoardTarget, TheFirstCornerIsWhereItsInkBegins) {
  const Board board = {.cols = 10, .rows = 8, .square_mm = 6.6};
  const ImageF ink = ink_picture(board, 0.0);
  const BoardTarget target = board_target(board, "ink.png", 0.8);
  const Vector2d repeat =
      TextureMapping(target.material.texture).at(target.part_from_board * Vector3d::Zero());
  const Vector2d corner = repeat.cwiseProduct(Vector2d(ink.width(), ink.height()));
  const int x = static_cast<int>(std::lround(corner.x()));
  EXPECT_NEAR(corner.x(), x, 1e-6);
  EXPECT_NEAR(corner.x() * 0.04125, board_sheet(board).first_corner_mm.x(), 0.5 * 0.04125);
  EXPECT_NEAR(corner.y(), 402.0, 1e-6);
  // Dark above to the left and below to the right.
  EXPECT_EQ(ink(x - 1, 401), 0.0F);
  EXPECT_EQ(ink(x, 401), 1.0F);
  EXPECT_EQ(ink(x - 1, 402), 1.0F);
  EXPECT_EQ(ink(x, 402), 0.0F);
  // So is the last one: 9 squares of 160 points on.
  EXPECT_EQ(ink(x + 1440 - 1, 401), 1.0F);
  EXPECT_EQ(ink(x + 1440, 401), 0.0F);
}

TEST(BoardTarget, TheCornersPlaneIsThePlatesTop) {
  const BoardTarget target = board_target(kMarked, "ink.png", 0.8);
  const Vector3d corner = target.part_from_board * Vector3d::Zero();
  EXPECT_EQ(corner.z(), 0.5 * target.part.thickness_mm);
  EXPECT_EQ(target.part_from_board.rotation.determinant(), 1.0);
  EXPECT_EQ(target.part_from_board.rotation * Vector3d::UnitY(), -Vector3d::UnitY());
}

}  // namespace
}  // namespace glint

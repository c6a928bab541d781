// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/board_sheet.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "hardware/board/charuco.h"
#include "hardware/board/find_board.h"

namespace glint {
namespace {

using testing::HasSubstr;

/// The sheet as a picture of so many pixels a mm.
Image<std::uint8_t> scanned(const BoardSheet& sheet, double px_per_mm) {
  const Eigen::Vector2d size = px_per_mm * sheet.size_mm;
  Image<std::uint8_t> picture(static_cast<int>(size.x()), static_cast<int>(size.y()), 220);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const Eigen::Array2d at = Eigen::Array2d(x + 0.5, y + 0.5) / px_per_mm;
      const auto is_in = [&](const SheetRectangle& r) {
        const Eigen::Array2d inside = at - r.corner_mm.array();
        return (inside >= 0.0).all() && (inside < r.size_mm.array()).all();
      };
      const auto is_in_dot = [&](const Eigen::Vector2d& dot) {
        return (at.matrix() - dot).norm() < sheet.dot_radius_mm;
      };
      if (std::ranges::any_of(sheet.dark, is_in) &&
          std::ranges::none_of(sheet.dots_mm, is_in_dot)) {
        picture(x, y) = 30;
      }
    }
  }
  return picture;
}

void expect_corners(const Board& board) {
  const BoardSheet sheet = board_sheet(board);
  const double px_per_mm = 4.0;
  const BoardView view = find_board(scanned(sheet, px_per_mm), board);
  ASSERT_TRUE(view.is_accepted()) << view.why;
  EXPECT_TRUE(view.is_orientation_known);
  ASSERT_EQ(view.picture_px.size(), static_cast<std::size_t>(num_corners(board)));
  for (std::size_t i = 0; i < view.picture_px.size(); ++i) {
    const Eigen::Vector2d wanted = px_per_mm * (sheet.first_corner_mm + view.board_mm[i].head<2>());
    EXPECT_LT((view.picture_px[i] - wanted).norm(), 0.1);
  }
}

TEST(BoardSheet, ShowsABoardThatIsFoundAgainTheRightWayUp) {
  expect_corners({.cols = 6, .rows = 4, .square_mm = 10.0, .mark = true});
  expect_corners({.cols = 6, .rows = 5, .square_mm = 10.0});
  expect_corners({.kind = BoardKind::kCharuco, .cols = 4, .rows = 3, .square_mm = 20.0});
  expect_corners({.kind = BoardKind::kCharuco,
                  .cols = 4,
                  .rows = 4,
                  .square_mm = 20.0,
                  .marker_mm = 12.0,
                  .dictionary = MarkerDictionary::k6x6});
}

TEST(BoardSheet, HasItsSizesInMm) {
  const Board board = {.cols = 10, .rows = 8, .square_mm = 20.0};
  const BoardSheet sheet = board_sheet(board);
  // 11 squares and a border of one on both sides: 13 x 20 mm wide.
  EXPECT_DOUBLE_EQ(sheet.size_mm.x(), 260.0);
  EXPECT_EQ(sheet.dark.size(), 50U);  // of 99 squares the odd ones: 50 dark, 49 white
  const std::string svg = sheet_svg(sheet);
  EXPECT_THAT(svg, HasSubstr("width=\"260.0000mm\""));
  EXPECT_THAT(svg, HasSubstr("M20.0000 20.0000h20.0000v20.0000h-20.0000z"));
  EXPECT_THAT(svg, HasSubstr("cols = 10, rows = 8 inner corners, square_mm = 20"));
}

TEST(BoardSheet, PdfHasItsObjectsWhereItsTableSays) {
  const std::string pdf = sheet_pdf(board_sheet({.cols = 10, .rows = 8, .square_mm = 20.0}));
  EXPECT_TRUE(pdf.starts_with("%PDF-1.4\n"));
  // 260 mm are 260 / 25.4 x 72 = 737.0079 points.
  EXPECT_THAT(pdf, HasSubstr("/MediaBox [0 0 737.0079 "));
  // The sheet is 9 squares, two borders and three lines high: 180 + 40 + 3 x 4.2 = 232.6 mm. The
  // first square's lower edge is 40 mm below its top.
  EXPECT_THAT(pdf, HasSubstr("20.0000 192.6000 20.0000 20.0000 re"));
  const std::size_t table = pdf.find("xref\n0 6\n");
  ASSERT_NE(table, pdf.npos);
  EXPECT_THAT(pdf, HasSubstr(fmt::format("startxref\n{}\n", table)));
  for (std::size_t i = 1; i <= 5; ++i) {
    const std::size_t row = table + 9 + 20 * i;
    const std::size_t at = std::stoul(pdf.substr(row, 10));
    EXPECT_EQ(pdf.substr(at, 7), fmt::format("{} 0 obj", i));
  }
  const std::size_t stream = pdf.find("stream\n") + 7;
  const std::size_t length = std::stoul(pdf.substr(pdf.find("/Length ") + 8));
  EXPECT_EQ(pdf.substr(stream + length, 9), "endstream");
}

TEST(CharucoMarkers, LieInTheWhiteSquaresRowByRow) {
  const auto markers = charuco_markers({.kind = BoardKind::kCharuco, .cols = 4, .rows = 3});
  ASSERT_EQ(markers.size(), 10U);  // of 5 x 4 squares every second
  EXPECT_EQ(markers[0].square, Eigen::Vector2i(1, 0));
  EXPECT_EQ(markers[2].square, Eigen::Vector2i(0, 1));
  EXPECT_EQ(markers[0].side, 6);
  EXPECT_TRUE(markers[0].is_dark[0]);
}

}  // namespace
}  // namespace glint

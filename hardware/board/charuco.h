// SPDX-License-Identifier: GPL-3.0-or-later
//
// ChArUco boards: their markers as they are printed, and found again in pictures. The layout is
// that of OpenCV from 4.6 on: first square dark, markers in the white squares row by row. Boards
// with an even number of rows of squares that begin with a white one, as OpenCV before 4.6 (its
// legacy pattern) and makers of boards print them, are found, too.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hardware/board/board.h"
#include "hardware/board/board_view.h"
#include "hardware/board/picture_levels.h"

namespace glint {

/// A marker as it is printed.
struct CharucoMarker {
  int id = 0;
  Eigen::Vector2i square = {0, 0};  ///< column and row, counted from the first square
  /// Modules, its dark border included, row by row: true is dark. side x side.
  std::vector<bool> is_dark;
  int side = 0;
};

/// @param board  of kind kCharuco
std::vector<CharucoMarker> charuco_markers(const Board& board);

/// See find_board(). @return empty where no marker of the board was found
std::optional<BoardView> find_charuco(PictureLevels& levels, const Board& board);

}  // namespace glint

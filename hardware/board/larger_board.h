// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether the board in a picture goes on where the board that is looked for ends.
#pragma once

#include <Eigen/Core>

#include "hardware/board/board.h"
#include "hardware/board/corner_guesses.h"
#include "hardware/board/picture_levels.h"

namespace glint {

/// Columns and rows that the board in the picture has at least: one more on each axis beyond whose
/// first or last line another whole line of corners is seen. 0, 0 when there is none: the board
/// ends where it should. A line that is not wholly in the picture says nothing.
/// @param guesses   of the grid that the board was found in
/// @param contrast  of the board's own corners
/// Cost: that of one corner's fit for each side of a board that ends.
Eigen::Vector2i larger_grid(PictureLevels& levels,
                            int level,
                            const Board& board,
                            const GridPlacement& placement,
                            const CornerGuesses& guesses,
                            double contrast);

/// The same of a grid of which more than a line lies beyond the board: its own columns and rows,
/// the longer side that of the board's longer one; 0, 0 where a tenth of its corners is missing.
Eigen::Vector2i larger_grid(const Board& board, const CornerGrid& grid);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A calibration board in a picture, or the reason why there is none to be used.
#pragma once

#include "core/image/image_io.h"
#include "hardware/board/board.h"
#include "hardware/board/board_view.h"

namespace glint {

/// The board's corners, each placed at full resolution with a window and a smoothing that suit the
/// blur and the noise around it (corner_fit.h). The board is looked for on means of 2^n x 2^n
/// pixels, first on that whose longer side is at most 500 px, then on finer and coarser ones.
///
/// A checkerboard is accepted only when all its inner corners are in the picture and were measured;
/// the outer squares may be cut. Of a ChArUco board six corners suffice, of two rows and two
/// columns. Squares must be at least 8 px wide. Cost: where a checkerboard is, some 10 operations a
/// pixel and 10 to 50 us a corner.
BoardView find_board(const Pixels& picture, const Board& board);

}  // namespace glint

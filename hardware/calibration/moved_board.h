// SPDX-License-Identifier: GPL-3.0-or-later
//
// A board, or a camera, that was moved between two pictures.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "hardware/calibration/robust_hand_eye.h"

namespace glint {

struct MovedBoard {
  std::size_t first_after = 0;  ///< first picture with the board at its new place
  double moved_mm = 0.0;        ///< of the board's middle
  double turned_rad = 0.0;
};

/// Looks for a place in the row of pictures where two calibrations, one before and one after it,
/// agree four times better with their pictures than one of all does, 80 of 100 pictures counted.
/// Each part needs 5 pictures, so a board that moved before the last fifth is found.
/// @param pairs  in the order in which the pictures were taken
/// Cost: that of 50 robust_hand_eye().
std::optional<MovedBoard> find_moved_board(Mounting mounting,
                                           std::span<const PosePair> pairs,
                                           const BoardSymmetry& symmetry,
                                           std::uint64_t seed);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one picture shows of a calibration board.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "hardware/board/board.h"

namespace glint {

/// What became of a picture.
enum class BoardOutcome {
  kAccepted,
  kNoBoard,    ///< no board, or not this one
  kCutOff,     ///< some of the board's corners lie outside the picture or at its border
  kBlurred,    ///< more than a fifth of a square
  kSaturated,  ///< corners lie in clipped light
  kDark,       ///< too little contrast above the noise
  kDoubled     ///< the same view as an earlier picture
};

/// "accepted", "no board", "cut off", "blurred", "saturated", "dark", "doubled"
std::string outcome_name(BoardOutcome outcome);

/// The corners of a board in one picture. Corners are only given where it was accepted.
struct BoardView {
  BoardOutcome outcome = BoardOutcome::kNoBoard;
  std::string why;  ///< of a picture that was not accepted, for people: "37 of 63 corners found"
  std::vector<Eigen::Vector3d> board_mm;    ///< corners on the board, z = 0
  std::vector<Eigen::Vector2d> picture_px;  ///< the same in the picture
  std::vector<double> blur_px;              ///< standard deviation at each corner, pixel included
  double noise =
      0.0;  ///< of a pixel and what the model of a corner lacks, share of full scale (median)
  double contrast = 0.0;              ///< bright minus dark, share of full scale (median)
  bool is_orientation_known = false;  ///< else the board may be turned round (num_symmetries())
  /// Columns and rows that the board in the picture has at least, where it is larger than the one
  /// looked for and so none (kNoBoard); else 0, 0.
  Eigen::Vector2i larger_grid = Eigen::Vector2i::Zero();

  bool is_accepted() const { return outcome == BoardOutcome::kAccepted; }
};

/// A picture that was not accepted.
BoardView refused_view(BoardOutcome outcome, std::string why);

/// No board of the kind looked for, but a larger one.
BoardView refused_as_larger(const Board& board, const Eigen::Vector2i& larger_grid);

/// Rejects views that show the board where an earlier accepted one has it: all corners within
/// limit_px of each other. Their `why` tells the earlier picture's name.
/// @param names  of the pictures, as many as views
void reject_doubled(std::vector<BoardView>& views,
                    const std::vector<std::string>& names,
                    double limit_px = 0.1);

}  // namespace glint

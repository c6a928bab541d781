// SPDX-License-Identifier: GPL-3.0-or-later
//
// All corners of a calibration as a table, from which it can be computed again without pictures.
//
//   picture, width_px, height_px      file as it was given, and its size
//   board_x_mm, board_y_mm            corner on the board, as it was found
//   x_px, y_px                        corner in the picture; (0, 0) is the outer corner of a pixel
//   residual_x_px, residual_y_px      found minus computed; empty where none is known
//   used                              yes or no
//   outcome                           of the search for the board: outcome_name()
//   reason                            more on a board that was not found, or why a picture with one
//                                     is not used
//   orientation                       known, or unknown: the picture does not tell which way round
//                                     the board lies
//
// A picture without corners has one row with empty numbers. Reading needs neither residuals nor
// used; without orientation, as in tables of before, it is known, and without outcome it begins the
// reason: "dark: white is 3 % of full scale".
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "studies/calibrate/calibrate_input.h"
#include "studies/calibrate/solved_calibration.h"

namespace glint {

/// @param residuals_px  corner_residuals_px()
std::string corners_csv(const CalibrateInput& input,
                        const SolvedCalibration& solved,
                        const std::vector<std::vector<Eigen::Vector2d>>& residuals_px);

/// Pictures as they were found, in the order of the file.
struct FoundCorners {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::string> names;
  std::vector<BoardView> views;  ///< without noise and blur
};

/// @param file  for messages
/// @throws ConfigError with file:line:column
FoundCorners parse_corners(std::string_view text, const std::string& file);

/// The corners of a file are to be those of the board that is given with it.
/// @throws ConfigError naming the file and a corner that the board has not
void check_corners(const FoundCorners& found, const Board& board, const std::string& file);

}  // namespace glint

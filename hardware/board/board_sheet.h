// SPDX-License-Identifier: GPL-3.0-or-later
//
// A calibration board as a sheet to print at true scale.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "hardware/board/board.h"

namespace glint {

/// An upright rectangle, mm from the sheet's top left corner, y downwards.
struct SheetRectangle {
  Eigen::Vector2d corner_mm = {0.0, 0.0};  ///< top left
  Eigen::Vector2d size_mm = {0.0, 0.0};
};

/// What is on the sheet.
struct BoardSheet {
  Eigen::Vector2d size_mm = {0.0, 0.0};
  Eigen::Vector2d first_corner_mm = {0.0, 0.0};  ///< inner corner (0, 0)
  std::vector<SheetRectangle> dark;  ///< squares, markers; neighbours of one row of a marker as one
  std::vector<Eigen::Vector2d> dots_mm;  ///< centres of white dots
  double dot_radius_mm = 0.0;
  std::vector<std::string> words;  ///< lines below the board: what it is, its keys, how to print it
  Eigen::Vector2d words_mm = {0.0, 0.0};  ///< left end of the first line's letters' feet
  double word_height_mm = 0.0;
  double ruler_mm = 0.0;  ///< length of the line below the words, to be checked with a ruler
};

/// The board with a white border of one square, at least 10 mm, and lines of text below it.
BoardSheet board_sheet(const Board& board);

/// As SVG, in mm. Equal boards give equal bytes.
std::string sheet_svg(const BoardSheet& sheet);

/// As PDF 1.4 of one page of the sheet's size: filled paths and Helvetica, no fonts embedded.
/// Source: ISO 32000-1:2008, 7.5 and 8.5.
std::string sheet_pdf(const BoardSheet& sheet);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Calibration boards as their files describe them. A board has (cols + 1) x (rows + 1) squares, of
// which the first one, beside the first inner corner, is dark, and those next to a dark one white.
//
// Frame of a board: origin in the first inner corner, +x along the columns, +y along the rows, +z
// away from the viewer; so all corners have z = 0. Seen from the front with the first square at the
// top left, +x points right and +y down.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/config/keys.h"

namespace glint {

enum class BoardKind {
  kCheckerboard,
  kCharuco  ///< a checkerboard with ArUco markers in its white squares, told apart by their bits
};

/// Where the board and the camera are fixed.
enum class BoardSetup {
  kNone,       ///< no robot, or not said
  kEyeInHand,  ///< the camera on the flange
  kEyeToHand   ///< the board on the flange
};

/// The markers of a ChArUco board: the first ones of the dictionary, row by row.
enum class MarkerDictionary { k4x4, k5x5, k6x6, k7x7 };

/// A calibration board; the keys of board.toml and board.json.
struct Board {
  BoardKind kind = BoardKind::kCheckerboard;
  int cols = 10;           ///< inner corners in a row, 3 to 100
  int rows = 8;            ///< inner corners in a column, 3 to 100
  double square_mm = 6.6;  ///< side of a square
  /// Checkerboard: a round dot of the other colour, 0.4 squares wide, in the middle of the first
  /// square. It settles which corner is the first one.
  bool mark = false;
  double marker_mm = 0.0;  ///< ChArUco: side of a marker; 0: 0.7 squares
  MarkerDictionary dictionary = MarkerDictionary::k4x4;
  BoardSetup setup = BoardSetup::kNone;
};

/// Diameter of the orientation mark, in squares.
inline constexpr double kMarkSquares = 0.4;

void visit_keys(KeyVisitor& keys, Board& board);

/// How many inner corners the board has.
int num_corners(const Board& board);

/// The inner corner of a column and a row, counted from 0; also beyond the board's own.
Eigen::Vector3d corner_mm(const Board& board, int col, int row);

/// The inner corners row by row; z = 0.
std::vector<Eigen::Vector3d> corners_mm(const Board& board);

/// Side of a marker, mm.
double marker_side_mm(const Board& board);

/// How many turns, of the four by a quarter, lay the board onto itself: 1 when its first corner can
/// always be told, by its mark, its markers or its colours (one side with an even, one with an odd
/// number of squares); else 2, or 4 where all its corners look alike.
int num_symmetries(const Board& board);

/// A board from TOML (table [board]) or JSON (an object, or one with the object "board"), told
/// apart by the file's ending.
/// @throws ConfigError with file:line:column of each problem, IoError
Board read_board(const std::filesystem::path& path);

/// @param file  for messages
/// @throws ConfigError with file:line:column
Board parse_board_json(std::string_view text, const std::string& file);

/// The board as the text of a board.toml, which reads back as the same.
std::string board_toml(const Board& board);

}  // namespace glint

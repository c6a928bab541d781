// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/board.h"

#include <array>

#include <fmt/format.h>

#include "core/config/key_writer.h"
#include "core/config/located_json.h"
#include "core/config/toml.h"
#include "core/file.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 2> kKinds = {"checkerboard", "charuco"};
constexpr std::array<std::string_view, 3> kSetups = {"none", "eye_in_hand", "eye_to_hand"};
constexpr std::array<std::string_view, 4> kDictionaries = {"4x4", "5x5", "6x6", "7x7"};
constexpr double kMarkerSquares = 0.7;
constexpr int kMaxMarkers = 1000;  ///< in each dictionary

bool has_enough_markers(const Board& board) {
  return board.kind != BoardKind::kCharuco ||
         (board.cols + 1) * (board.rows + 1) <= 2 * kMaxMarkers;
}

Board board_of(const ConfigNode& root) {
  const ConfigNode* table = root.is_table() ? root.find("board") : nullptr;
  std::vector<Problem> errors;
  Board board;
  KeyReader reader(table == nullptr ? &root : table, table == nullptr ? "" : "board", errors);
  visit_keys(reader, board);
  for (const std::string_view key : {"cols", "rows", "square_mm"}) {
    reader.require(reader.is_given(key), key, "is missing: a board needs cols, rows and square_mm");
  }
  reader.report_unknown();
  throw_if_any(errors);
  return board;
}

}  // namespace

void visit_keys(KeyVisitor& keys, Board& board) {
  keys.choice("kind", board.kind, kKinds, "what is printed on the board");
  keys.integer("cols", board.cols, Range::between(3, 100), "inner corners in a row");
  keys.integer("rows", board.rows, Range::between(3, 100), "inner corners in a column");
  keys.number("square_mm",
              board.square_mm,
              {.min = 0.0, .max = 1000.0, .min_excluded = true},
              "side of a square, as measured on the board");
  keys.boolean("mark",
               board.mark,
               "checkerboard: a round dot in the first square settles the board's orientation");
  keys.number("marker_mm",
              board.marker_mm,
              Range::between(0, 1000),
              "ChArUco: side of a marker; 0: 0.7 squares");
  keys.choice("dictionary", board.dictionary, kDictionaries, "ChArUco: bits of a marker");
  keys.choice("setup", board.setup, kSetups, "what the robot carries: camera or board");
  const bool is_charuco = board.kind == BoardKind::kCharuco;
  keys.require(!is_charuco || !board.mark, "mark", "is for checkerboards: markers tell the way up");
  keys.require(is_charuco || !keys.is_given("marker_mm"), "marker_mm", "is for kind = \"charuco\"");
  keys.require(
      is_charuco || !keys.is_given("dictionary"), "dictionary", "is for kind = \"charuco\"");
  keys.require(board.marker_mm < 0.95 * board.square_mm,
               "marker_mm",
               fmt::format("is {}, must be below 0.95 of square_mm", board.marker_mm));
  keys.require(has_enough_markers(board),
               "cols",
               fmt::format("a ChArUco board may have {} markers at most", kMaxMarkers));
}

int num_corners(const Board& board) {
  return board.cols * board.rows;
}

Eigen::Vector3d corner_mm(const Board& board, int col, int row) {
  return {col * board.square_mm, row * board.square_mm, 0.0};
}

std::vector<Eigen::Vector3d> corners_mm(const Board& board) {
  std::vector<Eigen::Vector3d> corners;
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      corners.push_back(corner_mm(board, col, row));
    }
  }
  return corners;
}

double marker_side_mm(const Board& board) {
  return board.marker_mm > 0.0 ? board.marker_mm : kMarkerSquares * board.square_mm;
}

int num_symmetries(const Board& board) {
  const bool differs_in_colour = (board.cols + board.rows) % 2 != 0;
  if (board.mark || board.kind == BoardKind::kCharuco || differs_in_colour) {
    return 1;
  }
  return board.cols == board.rows && board.cols % 2 == 0 ? 4 : 2;
}

Board read_board(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".toml") {
    return board_of(load_toml(path));
  }
  if (ending == ".json") {
    return parse_board_json(read_file(path), path.string());
  }
  throw ConfigError(fmt::format("{}: a board's file must end in .toml or .json", path.string()));
}

Board parse_board_json(std::string_view text, const std::string& file) {
  return board_of(parse_located_json(text, file));
}

std::string board_toml(const Board& board) {
  Board written = board;
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, written);
  if (board.kind == BoardKind::kCheckerboard) {
    ConfigNode own = ConfigNode::table();
    for (std::size_t i = 0; i < table.names.size(); ++i) {
      if (table.names[i] != "marker_mm" && table.names[i] != "dictionary") {
        own.names.push_back(table.names[i]);
        own.items.push_back(table.items[i]);
      }
    }
    table = own;
  }
  ConfigNode root = ConfigNode::table();
  set_path(root, "board", table);
  return to_toml(root);
}

}  // namespace glint

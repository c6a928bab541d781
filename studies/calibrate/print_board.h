// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --print_board`: a board as a sheet at true scale.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// Writes board.svg, board.pdf and board.toml; board.png and board_part.toml, which a scene takes
/// as its part; run.json.
/// @param board  board.toml or board.json
/// @param out    empty: out/<name of the file>/board
/// @return status, the board's keys, size_mm of the sheet, folder
/// @throws ConfigError with file:line:column, IoError; nothing is left behind
nlohmann::ordered_json print_board(const std::filesystem::path& board,
                                   const std::filesystem::path& out);

}  // namespace glint

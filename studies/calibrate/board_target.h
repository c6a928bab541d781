// SPDX-License-Identifier: GPL-3.0-or-later
//
// A calibration board as a part of a scene: its sheet of paper with the ink as a picture on it.
#pragma once

#include <filesystem>
#include <string>

#include "core/image/image.h"
#include "core/pose.h"
#include "hardware/board/board.h"
#include "simulator/geometry/part/part.h"
#include "simulator/material/material_settings.h"

namespace glint {

struct BoardTarget {
  PartSettings part;          ///< a plate of the sheet's size, its printed side up
  MaterialSettings material;  ///< dull paper; the ink's picture is its texture
  RigidTransform part_from_board;
};

/// How much of the paper's light each point of the sheet (board_sheet.h, without its words)
/// returns: 1, or `ink` on dark places. A square has kTexelsPerSquare points a side, so that edges
/// are sharp to some tenths of a pixel.
/// @param ink  in [0, 1)
ImageF ink_picture(const Board& board, double ink);

inline constexpr int kTexelsPerSquare = 160;

/// @param ink_file  of a picture as ink_picture() makes it
/// @param paper     reflectance of the paper
BoardTarget board_target(const Board& board, const std::filesystem::path& ink_file, double paper);

/// Tables [part] and [material] for scenes that include the text as a file.
std::string board_part_toml(const BoardTarget& target);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A board in the picture files of one camera.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "core/image/image_io.h"
#include "core/thread_pool.h"
#include "hardware/board/board.h"
#include "hardware/board/board_view.h"

namespace glint {

/// What the files show.
struct BoardsInFiles {
  int width_px = 0;
  int height_px = 0;
  std::vector<BoardView> views;  ///< of each file
  /// 10 or 12: of codes at the lower end of files of 16 bits; 0: all of a file's.
  int code_bits = 0;
  int largest_code = 0;  ///< of all files
};

/// Codes of 10 or 12 bits in files of 16, up to the largest one of all files, are spread over the
/// 16, so that dark and clipped light are known; the files are then read twice. Codes at the upper
/// end are taken as they are.
///
/// @param files  at least one
/// @param use    called with each picture as its file has it, once or twice, from several threads
/// @throws ConfigError for what is no picture, or of another size than the first one; IoError
BoardsInFiles find_boards(std::span<const std::filesystem::path> files,
                          const Board& board,
                          ThreadPool& pool,
                          const std::function<void(std::size_t, const Picture&)>& use);

}  // namespace glint

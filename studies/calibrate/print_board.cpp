// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/print_board.h"

#include <array>
#include <chrono>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/image_io.h"
#include "hardware/board/board.h"
#include "hardware/board/board_sheet.h"
#include "studies/calibrate/board_target.h"
#include "studies/output/result_folder.h"
#include "studies/output/result_writer.h"

namespace glint {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

// Reflectances of the sheet as the part of a scene.
constexpr double kPaper = 0.8;
constexpr double kInk = 0.04;

}  // namespace

Json print_board(const fs::path& board, const fs::path& out) {
  const auto start = std::chrono::steady_clock::now();
  const fs::path goal =
      out.empty() ? default_result_folder(board.stem().string(), ResultKind::kBoard) : out;
  const std::array<std::string, 6> names = {
      "board.svg", "board.pdf", "board.toml", "board.png", "board_part.toml", "run.json"};
  check_result_folder(goal, ResultKind::kBoard, names);
  check_inputs_kept(std::array{board}, goal, names);
  if (out.empty()) {
    check_source_of_folder(goal, {board});
  }
  const Board read = read_board(board);
  const BoardSheet sheet = board_sheet(read);
  ResultWriter writer(goal, ResultKind::kBoard);
  write_file(writer.path() / "board.svg", sheet_svg(sheet));
  write_file(writer.path() / "board.pdf", sheet_pdf(sheet));
  write_file(writer.path() / "board.toml", board_toml(read));
  write_png(writer.path() / "board.png", ink_picture(read, kInk / kPaper), PixelDepth::k8Bit);
  write_file(writer.path() / "board_part.toml",
             board_part_toml(board_target(read, "board.png", kPaper)));
  writer.finish({{"source", source_seen_from(goal, board)}}, start);
  return {{"schema", 1},
          {"status", "done"},
          {"cols", read.cols},
          {"rows", read.rows},
          {"square_mm", read.square_mm},
          {"size_mm", {sheet.size_mm.x(), sheet.size_mm.y()}},
          {"folder", goal.string()}};
}

}  // namespace glint

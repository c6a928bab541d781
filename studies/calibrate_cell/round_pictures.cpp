// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/round_pictures.h"

#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "hardware/board/board.h"
#include "studies/acquire/acquire_plan.h"
#include "studies/acquire/journal.h"
#include "studies/acquire/light_difference.h"
#include "studies/acquire/picture_grounds.h"
#include "studies/calibrate/known_calibration.h"
#include "studies/cell/cell_file.h"
#include "studies/cell/pose_numbers.h"
#include "studies/output/result_folder.h"

namespace glint::calibrate_cell_detail {

using Json = nlohmann::ordered_json;

std::optional<Json> ended_round(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "acquired.json";
  if (!std::filesystem::exists(file)) {
    return std::nullopt;
  }
  Json ended = Json::parse(read_file(file), nullptr, false);
  if (!ended.is_object() || ended.value("status", "stopped") == "stopped") {
    return std::nullopt;
  }
  // Where none was accepted, as with a lamp that was forgotten, all are taken again.
  const bool has_any = ended.value("counts", Json::object()).value("accepted", 0) > 0;
  return has_any ? std::optional(std::move(ended)) : std::nullopt;
}

namespace {

/// Pictures of an ended round that another prototype or power was seen by are none of this scene,
/// and those of another part, or by another camera, or one that was set otherwise, none of it or of
/// this cell.
void check_round(const AcquireOptions& options) {
  const AcquireSource source = read_source(options.source);
  Cell cell = read_cell(options.cell);
  if (!source.scene) {
    cell.stage.reset();  // wherever stripes stand, the corners of a board are where they are
  }
  check_recorded_grounds(options.out,
                         picture_grounds(source.scene ? &*source.scene : nullptr, cell));
  if (!source.scene) {
    return;
  }
  const std::string difference = light_difference(options.out, *source.scene);
  if (!difference.empty()) {
    throw ConfigError(
        fmt::format("{}: holds pictures of another prototype, or of lights at another power: {} "
                    "in its scene.toml than in the scene; name another folder",
                    options.out.string(),
                    difference));
  }
}

std::string board_text(const Board& board) {
  std::string text = fmt::format("{} x {} corners and squares of {} mm, a {}",
                                 board.cols,
                                 board.rows,
                                 board.square_mm,
                                 board.kind == BoardKind::kCharuco ? "ChArUco" : "checkerboard");
  if (board.kind == BoardKind::kCharuco) {
    text += fmt::format(" with markers of {0} mm and {1}x{1}",
                        marker_side_mm(board),
                        4 + static_cast<int>(board.dictionary));
  }
  return text;
}

}  // namespace

void check_rounds_folder(const std::filesystem::path& folder) {
  if (const auto kind = result_kind_of(folder)) {
    throw ConfigError(fmt::format("{}: holds results of `glint {}`; choose another output folder",
                                  folder.string(),
                                  command_of(*kind)));
  }
  for (const char* name : {"pictures", "poses.toml", "calibration"}) {
    if (is_there(folder / name) && !is_there(folder / "round_1")) {
      throw ConfigError(fmt::format(
          "{}: holds a {} that is not of `glint calibrate --cell`; choose another output folder",
          folder.string(),
          name));
    }
  }
}

void check_board(const std::filesystem::path& folder, const std::filesystem::path& board) {
  const std::filesystem::path calibration = folder / "calibration";
  if (!std::filesystem::exists(folder / "round_1") ||
      !std::filesystem::exists(calibration / "calibration.json")) {
    return;
  }
  const std::string there = board_text(read_calibration(calibration).given_board);
  const std::string now = board_text(read_board(board));
  if (there != now) {
    throw ConfigError(fmt::format(
        "{}: holds rounds of a board of {}, {} has {}; remove this folder, and the same command "
        "takes them anew, or only {} where the board is the same and its file was put right",
        folder.string(),
        there,
        board.string(),
        now,
        calibration.string()));
  }
}

Json acquire_round(const AcquireOptions& options,
                   MountedPrototypes& prototypes,
                   const MotionPermit& permit) {
  std::optional<Json> ended = ended_round(options.out);
  if (!ended) {
    return acquire_pictures(options, prototypes, permit);
  }
  check_round(options);
  return std::move(*ended);
}

std::string pose_convention_toml() {
  return "[convention]\nunit = \"mm\"\nrotation = \"rotation_vector\"\nangle = \"rad\"\n"
         "direction = \"base_from_flange\"\n";
}

std::string pose_toml(const std::string& picture, const Eigen::Isometry3d& base_from_flange) {
  return fmt::format(
      "\n[[pose]]\nname = \"{}\"\npose = {}\n", picture, six_numbers(base_from_flange).dump());
}

}  // namespace glint::calibrate_cell_detail

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures that one round of a calibration needs, and their poses as `glint calibrate` reads them.
// Private to the room.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "studies/acquire/acquire_run.h"

namespace glint::calibrate_cell_detail {

/// What acquired.json of a round holds that has ended; none: it has not, was stopped, or all its
/// pictures were rejected.
std::optional<nlohmann::ordered_json> ended_round(const std::filesystem::path& folder);

/// acquire_pictures(), but for a round that an earlier call has ended: it is not driven again, as
/// the arm may stand on the tour of a later one.
/// @return what acquired.json holds
/// @throws ConfigError also where the ended round was seen by other lights than the source has, is
///         of another part, or by a camera that the cell has set otherwise by now
nlohmann::ordered_json acquire_round(const AcquireOptions& options,
                                     MountedPrototypes& prototypes,
                                     const MotionPermit& permit);

/// A calibration in rounds is the only one in its folder.
/// @param folder  of the whole calibration, which may be begun, or not there
/// @throws ConfigError where results of a verb lie in it, or, before the first round, somebody's
///         files of the names that the calibration writes
void check_rounds_folder(const std::filesystem::path& folder);

/// Rounds of a folder are of the board that their calibration tells; without one all holds.
/// @param folder  of the whole calibration
/// @param board   board.toml or board.json
/// @throws ConfigError where these differ, which tells what to remove; IoError
void check_board(const std::filesystem::path& folder, const std::filesystem::path& board);

/// How the numbers of pose_toml() are meant.
std::string pose_convention_toml();

/// One [[pose]]. @param picture  its name
std::string pose_toml(const std::string& picture, const Eigen::Isometry3d& base_from_flange);

}  // namespace glint::calibrate_cell_detail

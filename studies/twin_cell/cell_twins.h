// SPDX-License-Identifier: GPL-3.0-or-later
//
// The twins of a cell's devices, wired to each other: what the camera takes follows the robot's arm
// and its digital outputs.
#pragma once

#include <filesystem>
#include <optional>

#include "studies/cell/twin_process.h"
#include "studies/twin_cell/truth.h"

namespace glint {

/// The file of truth that a cell names in [twin]. @throws ConfigError when it names none
std::filesystem::path truth_file_of(const Cell& cell);

/// Where a camera's twin listens.
struct CameraPlace {
  bool is_free = false;    ///< at the first free address
  bool has_cable = false;  ///< behind a cable that can be made bad by its side channel
};

/// The twin of a cell's camera alone, at the cell's address or the first free one from 127.0.0.1
/// on: it stands where the first safe position takes it, or at the scene's own viewpoint in a cell
/// without a robot, and all lights are on that no person has switched off.
/// @param place  of the camera; is_free: also where the cell has an address
/// @throws ConfigError for an address outside 127.0.0.0/8, IoError for one that is taken
ServingTwins camera_twin_of(const Cell& cell, CameraPlace place, int threads);

/// Both, and the stage where the cell has a linear one. Each motion waits, and the robot's clock
/// with it, until the pictures of its goal are rendered; outputs turn on the lights that the cell
/// has behind them, lights of other kinds are on until they are switched off.
/// @param port  as robot_twin_of(); 0 also: any free address for the camera
ServingTwins both_twins_of(const Cell& cell, std::optional<int> port, bool has_cable, int threads);

}  // namespace glint

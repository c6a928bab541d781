// SPDX-License-Identifier: GPL-3.0-or-later
//
// The file by which twins that serve are found: {"pid", "twins": [{"kind": "robot", "address",
// "rtde_port", ...}, ...]}. Anybody may have written it, so each field is looked at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "studies/cell/cell_file.h"

namespace glint {

/// @throws ConfigError for another file, IoError
nlohmann::ordered_json read_ready(const std::filesystem::path& file);

/// The twin of that kind; nullptr: there is none.
/// @param ready  of read_ready()
const nlohmann::ordered_json* twin_of_kind(const nlohmann::ordered_json& ready,
                                           std::string_view kind);

/// The socket of a twin's side channel. @throws ConfigError when it names none
std::filesystem::path side_channel_in(const std::filesystem::path& file,
                                      const nlohmann::ordered_json& twin);

/// The number by which a twin is told from one that took its address later.
/// @throws ConfigError when it names none
std::uint64_t token_in(const std::filesystem::path& file, const nlohmann::ordered_json& twin);

/// Which devices of a cell a verb drives.
enum class DrivenDevices { kRobot, kCamera, kAll };

/// A cell of nothing but twins: addresses, ports and tokens of its robot, camera and linear stage
/// are those of a ready file. What has no twin there and is not driven is left out of the cell.
/// @throws ConfigError for what is driven and has no twin, for ports that wrong_port() names, for
///         twins without a token, and for addresses that are not of 127.0.0.0/8, which twins alone
///         serve: such a file leads to something else; IoError
Cell with_ports(Cell cell, const std::filesystem::path& ready_file, DrivenDevices driven);

/// Asks what is at the address of a cell's twin to prove that it is the one of the ready file, and
/// again where it is late.
/// @param place  the address, for people
/// @param token  the file's
/// @param prove  the token that a device and the side channel at its address both tell; none: they
///               do not
/// @throws IoError unless it is the file's
void check_twin_token(const Cell& cell,
                      const std::string& place,
                      std::optional<std::uint64_t> token,
                      const std::function<std::optional<std::string>()>& prove);

/// Whether the robot of the cell proves that it is a twin (twin_proof.h); where the cell is one of
/// twins, the one of the ready file.
/// @throws IoError when it does not and the cell is one of twins: nothing else is driven then;
///         ConfigError when the cell has no robot
bool is_robot_twin(const Cell& cell);

/// In a cell of twins the linear stage has to prove that it is the one of the ready file: by the
/// text that its controller keeps. In others, and for what shows pictures, nobody is asked.
/// @throws IoError when it does not; nothing has moved then
void check_stage_twin(const Cell& cell);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The file by which twins that serve are found: {"pid", "twins": [{"kind": "robot", "address",
// "rtde_port", ...}, ...]}. Anybody may have written it, so each field is looked at.
#pragma once

#include <filesystem>
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

/// A cell whose ports, and addresses of camera and stage, are those of a ready file.
/// @throws ConfigError for ports that wrong_port() names, and for addresses that are not of
///         127.0.0.0/8, which twins alone serve: such a file leads to something else; IoError
Cell with_ports(Cell cell, const std::filesystem::path& ready_file);

}  // namespace glint

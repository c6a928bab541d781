// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// A JSON file of a folder of results.
/// @throws IoError with the file's name when it cannot be read, is cut short or is no JSON
nlohmann::ordered_json read_json(const std::filesystem::path& path);

}  // namespace glint

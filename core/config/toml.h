// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/config/config.h"

namespace glint {

/// Parses TOML. @throws ConfigError with file:line:column.
ConfigNode parse_toml(std::string_view text, const std::string& file);

/// Reads a TOML file and what it includes (`include = ["base.toml"]`, relative to the file); later
/// keys win. @throws IoError, ConfigError (also for a file that includes itself).
ConfigNode load_toml(const std::filesystem::path& path);

/// The value of a `--set key=value` argument: TOML, or plain text when it is no TOML value.
ConfigNode parse_override(std::string_view text);

}  // namespace glint

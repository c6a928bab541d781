// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/config/config.h"

namespace glint {

/// Parses TOML. @throws ConfigError with file:line:column.
ConfigNode parse_toml(std::string_view text, const std::string& file);

/// No study file may be larger, MB: whoever names a device or a mesh by mistake is told so.
inline constexpr int kMaxTomlMegabytes = 4;

/// Reads a TOML file and what it includes (`include = ["base.toml"]`, relative to the file); later
/// keys win. Pipes are read as files are.
/// @throws IoError, ConfigError: also for a file that includes itself, and for one that is too
/// large
ConfigNode load_toml(const std::filesystem::path& path);

/// The value of a `--set key=value` argument: TOML, or plain text when it is no TOML value.
ConfigNode parse_override(std::string_view text);

}  // namespace glint

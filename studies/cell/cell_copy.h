// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace glint {

/// The text of a cell's file with what it includes, and with full paths: it may be read from
/// anywhere on this machine. @throws ConfigError, IoError
std::string cell_copy(const std::filesystem::path& file);

}  // namespace glint

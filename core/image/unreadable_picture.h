// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace glint {

/// Tells why a library could not read a picture.
/// @param reason  in the library's words
/// @throws IoError when the file cannot be opened, else ConfigError: it holds something else
[[noreturn]] void throw_unreadable_picture(const std::filesystem::path& path, std::string reason);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/unreadable_picture.h"

#include <algorithm>
#include <cerrno>
#include <fstream>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace fs = std::filesystem;

void throw_unreadable_picture(const fs::path& path, std::string reason) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    throw IoError(path.string() + ": cannot be read: it is a folder");
  }
  errno = 0;
  if (!std::ifstream(path, std::ios::binary)) {
    throw IoError(fmt::format("{}: cannot be read: {}", path.string(), last_system_error()));
  }
  std::ranges::replace(reason, '\n', ' ');
  throw ConfigError(fmt::format("{}: is no picture, or a damaged one: {}", path.string(), reason));
}

}  // namespace glint

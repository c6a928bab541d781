// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/twin_secret.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "core/error.h"

namespace glint {

std::uint64_t fresh_token() {
  std::uint64_t token = 0;
  while (token == 0) {
    if (::getentropy(&token, sizeof(token)) != 0) {
      throw IoError("no random numbers: " + last_system_error());
    }
  }
  return token;
}

void make_private_folder(const std::filesystem::path& folder) {
  struct stat status = {};
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    throw IoError(folder.string() + ": " + last_system_error());
  }
  if (::lstat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode) ||
      status.st_uid != ::geteuid() || (status.st_mode & 0077) != 0) {
    throw IoError(folder.string() + ": must be a folder that only you may enter (mode 0700)");
  }
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lock beside a study's database. Private to the module.
#pragma once

#include <filesystem>

namespace glint {

/// A lock that the system drops when the process ends, however it ends. The file goes with it.
class LockFile {
 public:
  /// @throws IoError when another process holds it, or when it cannot be written
  explicit LockFile(std::filesystem::path path);
  ~LockFile();
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;

 private:
  bool try_lock();

  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace glint

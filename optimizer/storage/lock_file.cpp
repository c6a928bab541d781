// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/storage/lock_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <utility>

#include "core/error.h"

namespace glint {

LockFile::LockFile(std::filesystem::path path) : path_(std::move(path)) {
  while (!try_lock()) {
  }
}

LockFile::~LockFile() {
  ::unlink(path_.c_str());
  ::close(file_);
}

/// False when the former owner removed the file between our opening and locking it.
bool LockFile::try_lock() {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file_ < 0) {
    throw IoError(path_.string() + ": cannot be written: " + last_system_error());
  }
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    const bool is_held = errno == EWOULDBLOCK;
    const std::string reason = last_system_error();
    ::close(file_);
    throw IoError(path_.string() + ": " +
                  (is_held ? "another process is running this study" : reason));
  }
  struct stat ours = {};
  struct stat named = {};
  const bool is_same = ::fstat(file_, &ours) == 0 && ::stat(path_.c_str(), &named) == 0 &&
                       ours.st_ino == named.st_ino && ours.st_dev == named.st_dev;
  if (!is_same) {
    ::close(file_);
  }
  return is_same;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <string>

#include <unistd.h>

#include "core/error.h"
#include "core/file.h"

namespace glint {

/// An empty folder of its own for one test, removed with everything in it at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "glint_test_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw IoError(name + ": the folder cannot be made: " + last_system_error());
    }
    path_ = name;
  }

  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// How many entries the folder holds, hidden ones included.
  std::ptrdiff_t count() const {
    return std::distance(std::filesystem::directory_iterator(path_),
                         std::filesystem::directory_iterator());
  }

 private:
  std::filesystem::path path_;
};

/// Lets the next write_file or picture of that path meet a full disk: its temporary file is made a
/// link to the device that is always full.
inline void fill_disk_under(const std::filesystem::path& path) {
  std::filesystem::path temporary;
  { temporary = AtomicFile(path).temporary_path(); }
  std::filesystem::create_symlink("/dev/full", temporary);
}

/// The text of the Error a call throws; "nothing thrown" when it does not.
template <class ErrorType, class Call>
std::string text_thrown_by(const Call& call) {
  try {
    call();
  } catch (const ErrorType& error) {
    return error.what();
  }
  return "nothing thrown";
}

}  // namespace glint

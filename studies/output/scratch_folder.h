// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace glint {

/// A folder of its own among the system's temporary files, removed with everything in it.
class ScratchFolder {
 public:
  /// @param what  for: "the first designs of the search"
  /// @throws IoError
  explicit ScratchFolder(const char* what);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that the command line names.
#pragma once

#include <filesystem>
#include <vector>

namespace glint {

/// The folder that a file will lie in, "out" of "out/gear.toml", made where it is not there. What
/// was made and stays empty, as the file could not be written, goes with this object.
class FolderOf {
 public:
  /// @throws IoError when it cannot be made
  explicit FolderOf(const std::filesystem::path& file);
  ~FolderOf();
  FolderOf(const FolderOf&) = delete;
  FolderOf& operator=(const FolderOf&) = delete;

 private:
  void remove_empty() const;

  std::vector<std::filesystem::path> made_;  ///< the innermost first
};

}  // namespace glint

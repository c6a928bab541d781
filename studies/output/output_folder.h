// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace glint {

/// The folder results go to. What had to be created for it, parents included, is removed again
/// unless keep() is called: a run that is refused or cannot write leaves nothing behind.
class OutputFolder {
 public:
  /// @throws IoError
  explicit OutputFolder(const std::filesystem::path& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  void keep() { first_created_.clear(); }

 private:
  std::filesystem::path first_created_;  ///< empty: nothing to remove
};

/// Removes the unfinished files (core/file.h) that killed processes left in a folder.
void remove_unfinished_files(const std::filesystem::path& folder);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that appear in a folder together, when all of them are whole.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace glint {

/// What tells whose files a folder holds: it comes before the others, so that a process that is
/// killed in between leaves nothing of nobody known.
inline constexpr const char* kResolvedScene = "scene.resolved.toml";

/// The files of a folder in the order of their names; none when it cannot be read.
std::vector<std::filesystem::path> sorted_entries(const std::filesystem::path& folder);

/// Removes what processes that have ended left unfinished.
void remove_stale_stages(const std::filesystem::path& out);

/// A hidden folder beside its goal, removed again unless it is committed.
class StagedFolder {
 public:
  /// @param out   exists
  /// @param name  of the folder in `out` that it becomes; empty: its files come to `out` itself
  /// @throws IoError
  StagedFolder(std::filesystem::path out, std::string name);
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// A folder of that name which another process has finished meanwhile is kept.
  /// @throws IoError
  void commit();

 private:
  std::filesystem::path out_;
  std::string name_;
  std::filesystem::path path_;
};

}  // namespace glint

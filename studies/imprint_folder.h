// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where `glint imprint` writes: parts appear in their folder when they are whole, and a folder
// takes parts of one configuration only.
#pragma once

#include <filesystem>
#include <string>

#include "studies/study.h"

namespace glint {

inline constexpr const char* kResolvedScene = "scene.resolved.toml";

/// The resolved scene below a line that names everything its parts depend on: the configuration,
/// the part's file, the own tools and painted regions, and the program's version.
/// @param is_many  whether the folder holds numbered parts or one
std::string marked_scene_text(const Study& study, bool is_many);

/// @throws ConfigError when the folder holds parts of another configuration, files of those names
///         that are of nobody known, or a study's run
void check_imprint_folder(const std::filesystem::path& out, const std::string& marked_scene);

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

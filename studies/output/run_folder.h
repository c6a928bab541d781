// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace glint {

/// The file of a run's folder by which the folder is known: the study that it ran.
inline constexpr const char* kRunStudy = "study.resolved.toml";

/// The scene of a design's folder.
inline constexpr const char* kDesignScene = "scene.toml";

/// The folder of the run that a file or a folder lies in: the nearest one that holds the run's
/// study, the path itself or any folder above it. Folders of `glint render` and `glint cover` hold
/// a study and are no run. Links are not followed. Empty: it lies in none.
/// @param path  need not exist; relative to the working directory
std::filesystem::path run_above(const std::filesystem::path& path);

/// name_of_source() of what lies in no run; else the run's name, then where in the run it lies, as
/// each has a winner: "gear_winner" of out/gear/run/winner.
std::string name_within_run(const std::filesystem::path& path);

/// The full path that links lead to, as far as it exists; empty: of an empty one.
std::filesystem::path without_links(const std::filesystem::path& path);

}  // namespace glint

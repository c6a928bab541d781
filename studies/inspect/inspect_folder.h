// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where `glint inspect` writes. A folder takes inspections of the same parts only: what an earlier
// one of other parts left would pass for results of this one.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "studies/inspect/inspect_sources.h"

namespace glint {

/// What an inspection is called after: the only picture or folder, or the folder that holds the
/// inputs, a run or a rendering.
/// @param inputs  of the command line, at least one
std::filesystem::path source_of_inspection(std::span<const std::filesystem::path> inputs);

/// out/<name>/inspect: the name is that of source_of_inspection().
std::filesystem::path default_inspect_folder(std::span<const std::filesystem::path> inputs);

/// @param inputs       files that are read beside the pictures; empty paths are none
/// @param is_learning  whether a new grading.toml is written
/// @throws ConfigError when the folder holds results of another verb, an inspection of other parts,
///         learned limits that would not be renewed, files of nobody known, or an input where
///         results would be written
void check_inspect_folder(const std::filesystem::path& out,
                          std::span<const PicturedPart> parts,
                          std::span<const std::filesystem::path> inputs,
                          bool is_learning);

/// Removes what an earlier inspection wrote for the parts and this one does not: maps of another
/// filter. @param stage  the files to come
void remove_outdated_maps(const std::filesystem::path& out,
                          const std::filesystem::path& stage,
                          std::span<const PicturedPart> parts);

}  // namespace glint

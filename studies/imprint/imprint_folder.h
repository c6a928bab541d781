// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where `glint imprint` writes: parts appear in their folder when they are whole, and a folder
// takes parts of one configuration only.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/definition/study.h"
#include "studies/output/staged_folder.h"

namespace glint {

/// The resolved scene below a line that names everything its parts depend on: the configuration,
/// the part's file, the custom tools and painted regions, and the program's version.
/// @param is_many  whether the folder holds numbered parts or one
std::string marked_scene_text(const Study& study, bool is_many);

/// "part_0000": a numbered part and its folder.
std::string part_name(int part);

/// What appears in the folder. @param count  of numbered parts; 0: one part in the folder itself
std::vector<std::string> names_of_imprint(int count);

/// @param count  as above
/// @throws ConfigError when the folder holds parts of another configuration (it names the keys that
///         differ), files of those names that are of nobody known, or results of another verb
void check_imprint_folder(const std::filesystem::path& out, const Study& study, int count);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that the command line names.
#pragma once

#include <filesystem>

namespace glint {

/// Makes the folder that a file will lie in, where it is not there: "out" of "out/gear.toml".
/// @throws IoError when it cannot be made
void make_folder_of(const std::filesystem::path& file);

}  // namespace glint

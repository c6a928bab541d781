// SPDX-License-Identifier: GPL-3.0-or-later
//
// What an earlier result left in a folder into which another one is written.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

namespace glint {

/// Files of an earlier result in `out` that the finished one in `stage` does not replace.
/// @param entries  what the earlier one has written, relative to `out`: files, and folders with all
///                 that is in them; such as are not there are passed over, links are not followed
/// @param kept     files that are read: they are not among them
/// @return relative to `out`
std::vector<std::filesystem::path> unreplaced_files(const std::filesystem::path& out,
                                                    const std::filesystem::path& stage,
                                                    std::span<const std::filesystem::path> entries,
                                                    std::span<const std::filesystem::path> kept);

/// Removes these, and the folders in `out` that are empty then.
void remove_unreplaced(const std::filesystem::path& out,
                       std::span<const std::filesystem::path> files);

}  // namespace glint

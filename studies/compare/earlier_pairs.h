// SPDX-License-Identifier: GPL-3.0-or-later
//
// What an earlier comparison left in a folder that another one writes to.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace glint {

/// Where the files of a pair are: "pair_01" for 0.
std::string pair_folder(std::size_t index);

/// Names of the folders of pairs in a comparison's folder; none where it is no comparison's.
std::vector<std::string> earlier_pairs(const std::filesystem::path& out);

/// A person's own files in the folders of pairs may be read: they stay.
/// @param inputs  files that are read; an empty path is none
/// @param pairs   folders in `out` that a comparison writes to or removes files from
/// @throws ConfigError naming an input that is a file of a comparison in one of these folders
void check_inputs_kept_in_pairs(std::span<const std::filesystem::path> inputs,
                                const std::filesystem::path& out,
                                std::span<const std::string> pairs);

/// Files that an earlier comparison wrote to `out` and that the one in `stage` does not replace,
/// relative to `out`; none where it is no comparison's. They would be of other pictures. Files
/// under names that no comparison gives are not among them.
std::vector<std::filesystem::path> stale_files(const std::filesystem::path& out,
                                               const std::filesystem::path& stage);

/// Removes these, and folders of pairs that are empty then.
void remove_stale_files(const std::filesystem::path& out,
                        std::span<const std::filesystem::path> stale);

}  // namespace glint

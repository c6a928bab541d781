// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint inspect` is asked to look at: files, folders of pictures, folders of runs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace glint {

/// A part to be inspected.
struct PicturedPart {
  std::string name;  ///< unique; fit to be the name of a folder
  std::vector<std::filesystem::path> pictures;
  std::filesystem::path mask = {};   ///< of a simulated part; empty: none
  std::filesystem::path scene = {};  ///< the scene it was rendered from; empty: none
  std::filesystem::path truth = {};  ///< the list of its defects; empty: none

  /// A single picture of a real part: no scan that evens out the light.
  bool is_photograph() const { return pictures.size() == 1 && scene.empty(); }
};

/// Files are the pictures of one part, or (is_each) of a part each. A folder is a part; a folder of
/// a run, or of one of its designs, is every design in it that has pictures.
/// @throws ConfigError for none, for files beside folders and for folders without pictures; IoError
std::vector<PicturedPart> part_sources(const std::vector<std::filesystem::path>& inputs,
                                       bool is_each);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pose of the robot belongs to which picture.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace glint {

enum class PairBy {
  kAuto,
  kName,        ///< the file name, with or without its folders and ending
  kLastNumber,  ///< the last digits in the name: img_07.png and pose7.yaml
  kOrder        ///< the first pose to the first picture
};

struct Pairing {
  std::vector<std::size_t> pose_of;  ///< of each picture, in the pictures' order
  std::string told;                  ///< how they were paired and why, with the key that overrules
};

/// Pairs every picture with one pose. Auto takes names where all agree, else last numbers where
/// each is found exactly once on both sides, else the order, but that only when no pose has a name
/// and there are as many poses as pictures.
/// @param pictures    file names
/// @param pose_names  empty ones for poses without a name
/// @throws ConfigError naming pictures without a pose and poses without a picture; also when names
/// or numbers occur twice, or what auto would have to guess
Pairing pair_poses(std::span<const std::string> pictures,
                   std::span<const std::string> pose_names,
                   PairBy by);

}  // namespace glint

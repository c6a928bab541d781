// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pictures of a folder were taken at which level of light.
//
//   levels.csv   a row a picture: file, kind (bright or dark), exposure, photons (optional)
//   levels.txt   as the EMVA 1288 reference data have it: "b EXPOSURE PHOTONS" or "d EXPOSURE"
//                begins a level, "i FILE" is a picture of it; '#' begins a comment, and lines that
//                begin otherwise ("v", "n") are not needed
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "hardware/photon_transfer/level_statistics.h"

namespace glint {

struct LevelFiles {
  bool is_dark = false;
  double exposure = 0.0;  ///< in the unit of the file
  double photons = 0.0;   ///< on a pixel; 0: not told
  std::vector<std::filesystem::path> pictures;
};

/// @throws ConfigError with file:line, also for a picture that is listed twice
std::vector<LevelFiles> parse_levels_txt(std::string_view text, const std::filesystem::path& file);
std::vector<LevelFiles> parse_levels_csv(std::string_view text, const std::filesystem::path& file);

/// levels.csv, else levels.txt of the folder; paths are taken from there.
/// @throws ConfigError for neither, a level of fewer than two pictures, no level; IoError
std::vector<LevelFiles> read_levels(const std::filesystem::path& folder);

/// What the pictures hold in common.
struct CodeRange {
  int bits = 8;   ///< of the codes: 8, 10, 12 or 16
  int shift = 0;  ///< lowest bits of the file that are always 0
};

/// The least of 8, 10, 12 and 16 bits that the largest value of any picture needs, after bits that
/// are 0 in all of them were taken off.
CodeRange code_range(unsigned all_bits);

/// Codes of as many bits as the user says, at the upper end of 16 where all lower bits are 0 and
/// the highest is not, else at the lower end.
/// @param bits  8, 10, 12 or 16
/// @throws ConfigError where pictures hold larger codes
CodeRange told_range(int bits, unsigned all_bits);

}  // namespace glint

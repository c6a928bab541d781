// SPDX-License-Identifier: GPL-3.0-or-later
//
// A bank of corner errors as a file: one JSON object a line, first what all pictures share, then
// one for each picture in the order of their numbers.
//
//   {"schema":1,"seed":1,"scene":"...","inputs":"..."}
//   {"picture":0,"outcome":"accepted","f_number":4.0,"tilt_deg":21.3,"turn_deg":-12.9,
//    "corners":[[0.0123,-0.0045,0.71,148.2,412.3], ...]}      error x, y [px], blur [px],
//                                                             distance [mm], radius [px]
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/hardware/calibration/corner_bank.h"

namespace glint {

/// What all pictures of a bank share.
struct BankHeader {
  std::uint64_t seed = 1;  ///< of the poses
  std::string scene;       ///< camera, board and light in one line
  std::string inputs;      ///< SHA-256 of the whole study and the board; older banks tell none

  bool operator==(const BankHeader&) const = default;
};

/// A bank that grows, and goes on where it was interrupted.
class CornerBankFile {
 public:
  /// Takes what the file has; a last line that was cut off is dropped. Nothing is written.
  /// @throws ConfigError with file:line of what is wrong, also where the file has another header;
  ///         IoError
  CornerBankFile(std::filesystem::path path, const BankHeader& header);

  const std::vector<BankPicture>& pictures() const { return pictures_; }

  /// Adds the next picture; the file is replaced as a whole. Numbers are rounded: errors to 1e-4
  /// px, blurs and angles to 0.001, distances and radii to 0.1. @throws IoError
  void append(const BankPicture& picture);

 private:
  std::filesystem::path path_;
  std::string text_;
  std::vector<BankPicture> pictures_;
};

/// All pictures of a bank of any header. @throws as CornerBankFile; IoError when there is none
std::vector<BankPicture> read_corner_bank(const std::filesystem::path& path);

}  // namespace glint

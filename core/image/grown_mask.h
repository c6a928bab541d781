// SPDX-License-Identifier: GPL-3.0-or-later
//
// Masks grown by the square of +-radius pixels around each pixel that is set, row by row.
#pragma once

#include <vector>

#include "core/image/image.h"

namespace glint {

/// The rows of dilated() masks of 0 and 1 of one width, quicker. Not to be shared between threads.
class RowGrower {
 public:
  RowGrower(int width_px, int radius_px);

  /// Writes row y of the grown mask.
  void grow(const Mask& mask, int y, unsigned char* row);

 private:
  int width_px_;
  int radius_px_;
  std::vector<const unsigned char*> rows_;
  std::vector<unsigned char> scratch_;
};

}  // namespace glint

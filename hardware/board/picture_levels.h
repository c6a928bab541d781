// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture and its halves, quarters, ... as means of 2 x 2, 4 x 4, ... pixels. Because pixel (0,
// 0) begins at (0, 0), a point of the picture divided by the factor is the same point of a level.
#pragma once

#include <deque>

#include "core/image/image.h"
#include "core/image/image_io.h"

namespace glint {

/// The levels of one picture, made when they are asked for. Grey values from 0 to 1.
class PictureLevels {
 public:
  /// @param picture  must outlive the levels
  explicit PictureLevels(const Pixels& picture);

  int width() const { return width_; }

  int height() const { return height_; }

  /// Level 0 is the picture itself, level n has means of 2^n x 2^n pixels; a remainder at the right
  /// and bottom is left out. Level 0 is given as it is, without a copy where the picture has
  /// floats.
  const ImageF& level(int n);

  /// The part of a level with that top left pixel; it must lie in the level. Reads a few pixels of
  /// level 0 without converting all of it.
  ImageF part(int n, int x, int y, int width, int height);

  /// The lowest grey value that stands for a clipped pixel.
  double clipped_value() const { return clipped_value_; }

 private:
  ImageF reduced(int n);

  const Pixels& picture_;
  int width_ = 0;
  int height_ = 0;
  double clipped_value_ = 1.0;
  std::deque<ImageF> levels_;  ///< empty until asked for; references stay good
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// One side of a comparison, read and checked.
#pragma once

#include "core/image/image.h"
#include "studies/compare/compare_sources.h"

namespace glint {

struct ComparedPicture {
  CompareSource source;
  ImageF grey;  ///< linear, full scale 1; pictures of floats are scaled to that by their brightest
  int bits = 8;
  bool is_float = false;
  int channels = 1;

  int width() const { return grey.width(); }

  int height() const { return grey.height(); }
};

/// @throws IoError, ConfigError for a picture that is black or white all over, or has values that
///         are no finite numbers
ComparedPicture read_compared(const CompareSource& source);

}  // namespace glint

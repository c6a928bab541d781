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
  /// Floats beyond full scale, divided by their brightest: what exposure they have is not known.
  bool is_scaled = false;
  int channels = 1;
  int orientation = 1;  ///< as of picture_orientation(): greys are as they are stored

  int width() const { return grey.width(); }

  int height() const { return grey.height(); }
};

/// @param may_be_plain  whether one grey value all over, black too, is allowed: a photograph of a
///                      light that is dead
/// @throws IoError, ConfigError for a picture that is black or white all over, or has values that
///         are no finite numbers
ComparedPicture read_compared(const CompareSource& source, bool may_be_plain = false);

/// Whether a picture has one grey value all over.
bool is_plain(const ImageF& grey);

/// Whether a picture is dark (mean below 5 % of full scale) and its blocks of 16 x 16 pixels differ
/// by no more than noise between neighbouring pixels makes them (F test at 1 in 10^4 about).
bool is_dark_noise(const ImageF& grey);

/// The same of a picture that is nearly at full scale (mean above 95 % of it).
bool is_bright_noise(const ImageF& grey);

}  // namespace glint

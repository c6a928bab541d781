// SPDX-License-Identifier: GPL-3.0-or-later
//
// Mean and variances of pictures of an evenly lit surface, all taken alike.
#pragma once

#include <span>

#include "core/image/image.h"

namespace glint {

/// Variance that rounding to whole codes adds to noise, DN^2.
inline constexpr double kRoundingVariance = 1.0 / 12.0;

/// One level of light, in codes (digital numbers, DN).
struct LevelStatistics {
  bool is_dark = false;
  double exposure = 0.0;  ///< time of exposure, in any unit
  double photons = 0.0;   ///< mean number that fell on a pixel; 0: not known
  int pictures = 0;
  double mean_dn = 0.0;
  double temporal_variance_dn2 = 0.0;
  /// Of the mean picture over the pixels, without what noise leaves in it; may be a little below 0.
  double spatial_variance_dn2 = 0.0;
  double clipped_share = 0.0;  ///< of the pixels at full scale
  double zero_share = 0.0;     ///< of the pixels at code 0
  /// Standard error of the temporal variance, no less than of one that is rounding alone.
  double variance_error_dn2 = 0.0;
};

/// The temporal variance is that between the pictures after each picture's own mean was taken off,
/// so that a lamp that flickers does not count.
///
/// Source: EMVA Standard 1288, release 4.0 Linear, 6.5 and 8.1 (with more than two pictures their
/// mean).
/// @param pictures  at least 2 of one size, in codes
/// @param full_scale_dn  largest code
LevelStatistics level_statistics(std::span<const ImageF> pictures, double full_scale_dn);

/// Mean of pictures of one size; at least one.
Image<double> mean_picture(std::span<const ImageF> pictures);

}  // namespace glint

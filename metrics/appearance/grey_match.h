// SPDX-License-Identifier: GPL-3.0-or-later
//
// Grey values of two pictures of the same content, pixel by pixel. Formulas and sources of all of
// metrics/appearance: docs/theory/comparison.md.
#pragma once

#include <cstddef>

#include "core/image/image.h"

namespace glint {

/// What brings one picture's exposure to the other's: real = gain simulated + offset.
struct ExposureMatch {
  double gain = 1.0;    ///< > 0 for pictures of the same content
  double offset = 0.0;  ///< in grey, 0 where it is not asked for
  double rms = 0.0;     ///< of what is left
  std::size_t pixels = 0;
};

enum class ExposureModel { kGain, kGainAndOffset };

/// Least squares over the region. Pixels clipped in either picture (at or below 0, at or above
/// `full_scale`) are left out.
/// @param region  empty: all pixels
/// @throws ConfigError for pictures of different sizes
ExposureMatch match_exposure(const ImageF& simulated,
                             const ImageF& real,
                             const Mask& region = {},
                             ExposureModel model = ExposureModel::kGain,
                             double full_scale = 1.0);

/// gain picture + offset.
ImageF exposed(const ImageF& picture, const ExposureMatch& match);

/// real - simulated, 0 beside the region.
ImageF residual_picture(const ImageF& simulated, const ImageF& real, const Mask& region = {});

/// Normalised cross-correlation with means taken out, in [-1, 1]; 0 where either is constant.
double correlation_of(const ImageF& first, const ImageF& second, const Mask& region = {});

/// First Wasserstein distance of the grey values of two regions: the mean way that grey has to be
/// moved, in units of grey. The pictures may differ in size and content.
/// @throws ConfigError when a region is empty
double histogram_distance(const ImageF& first,
                          const ImageF& second,
                          const Mask& first_region = {},
                          const Mask& second_region = {});

}  // namespace glint

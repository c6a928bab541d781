// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two measures of structure for pictures of the same content. Both depend on what counts as the
// whole range of grey, which is therefore stated.
#pragma once

#include "core/image/image.h"

namespace glint {

/// Structural similarity of each pixel's surroundings, in [-1, 1]: a Gaussian window of 11 x 11
/// pixels with a standard deviation of 1.5, borders mirrored; C1 = (0.01 range)^2,
/// C2 = (0.03 range)^2.
/// Source: Z. Wang et al., "Image quality assessment: from error visibility to structural
/// similarity", IEEE Trans. Image Processing 13(4), 2004.
/// @param range  of grey values: 1 for linear values, > 0
/// @throws ConfigError for pictures of different sizes
ImageF ssim_map(const ImageF& first, const ImageF& second, double range = 1.0);

/// Mean of the map over a region. @param region  empty: all pixels @returns 1 for an empty region
double ssim(const ImageF& first, const ImageF& second, const Mask& region = {}, double range = 1.0);
double mean_in(const ImageF& map, const Mask& region);

/// Gradient magnitude similarity deviation, >= 0, 0 for equal pictures: means of 2 x 2 pixels,
/// Prewitt gradients, T = 170 / 255^2 range^2.
/// Source: W. Xue et al., "Gradient magnitude similarity deviation", IEEE Trans. Image Processing
/// 23(2), 2014.
/// @param region  a reduced pixel counts when all four of its pixels are in it; empty: all
double gmsd(const ImageF& first, const ImageF& second, const Mask& region = {}, double range = 1.0);

/// Of each of these reduced pixels how alike the gradients are, in (0, 1]: gmsd() is its deviation.
/// @throws ConfigError for pictures of different sizes
ImageF gradient_similarity_map(const ImageF& first, const ImageF& second, double range = 1.0);

/// Standard deviation of such a map. @param region  of whole pixels, as in gmsd()
double deviation_in(const ImageF& map, const Mask& region);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of two regions is common to both. Where the shares of pixels are known the figures are
// those of the outlines, not of their pixels: sums of the smaller and of the larger share.
#pragma once

#include "core/image/image.h"

namespace glint {

struct RegionOverlap {
  double iou = 1.0;       ///< intersection over union, in [0, 1]
  double dice = 1.0;      ///< twice the intersection over both areas, in [0, 1]
  double first_px = 0.0;  ///< areas
  double second_px = 0.0;
};

/// Two regions of one picture. Both empty: they agree, 1.
/// @throws ConfigError for different sizes
RegionOverlap overlap_of(const Mask& first, const Mask& second);

/// The same by the share of each pixel that a region covers, in [0, 1].
RegionOverlap overlap_of(const ImageF& first, const ImageF& second);

}  // namespace glint

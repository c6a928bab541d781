// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where scores are taken: the pixels wholly on the part, away from its rim and from the defects.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "metrics/aspect_image/settings.h"

namespace glint {

/// A defect as the picture shows it: how far each pixel around it is from its middle, in defect
/// radii. That serves round dents (radius), elongated ones (elliptical radius) and scratches
/// (distance from the line over half the width) alike, and windows of neighbours may overlap.
struct DefectView {
  /// Distance of pixels that are no neighbours at all.
  static constexpr float kFar = std::numeric_limits<float>::infinity();

  std::string label;
  int left_px = 0;       ///< column of the window's first pixel in the image
  int top_px = 0;        ///< row of the window's first pixel in the image
  ImageF distance;       ///< in radii, >= 0; the window, which lies inside the image
  double area_px = 0.0;  ///< true projected area, > 0; the rim is at distance 1
};

/// 1 where the whole pixel lies on the part.
/// @param coverage  share of each pixel's footprint that lies on the part, in [0, 1]
Mask whole_pixels(const ImageF& coverage);

/// Takes a rim away: keeps a pixel when the whole square of `rim_px` around it is inside. Beyond
/// the image counts as outside.
Mask eroded(const Mask& mask, int rim_px);

/// Clears the pixels within `radii` of each defect.
void exclude_defects(Mask& mask, std::span<const DefectView> defects, double radii);

std::size_t count_inside(const Mask& mask);

/// The region of interest for homogeneity: whole pixels, eroded, without defects.
/// @throws ConfigError when nothing is left
Mask region_of_interest(const ImageF& coverage,
                        std::span<const DefectView> defects,
                        const MetricsSettings& settings = {});

}  // namespace glint

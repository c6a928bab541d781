// SPDX-License-Identifier: GPL-3.0-or-later
//
// The derivative of pixels whose mean is T(w, D) of simulator/render/scan/shining_mean.h: that of a
// table under dark stripes whose light depends on the place (scan_gradient.h).
#pragma once

#include <vector>

#include "simulator/render/derivative/scan_gradient.h"

namespace glint {

/// A derivative of T(w, D) by a setting, and where its sum over the pixels goes.
struct ShiningSum {
  ShiningMean::Pieces pieces;  ///< at each level of the plan's tables
  double* sum = nullptr;
};

/// Adds the derivatives by the hits (x by the width of the stripes, y and margin by the dark
/// radiance) and by the nodes of DarkRadiance, and the sums.
/// @param by_aspect  derivative of the number by each pixel
/// @param plan       with its `shining` tables
/// @param variance   of a pixel's blur [px^2]
/// @return sum over the pixels of derivatives by both phase differences times these
double add_shining_gradient(const Footprints& footprints,
                            const ScanPlan& plan,
                            const ImageF& by_aspect,
                            double variance,
                            const std::vector<ShiningSum>& sums,
                            ScanGradient& gradient);

}  // namespace glint

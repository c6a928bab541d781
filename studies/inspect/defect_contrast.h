// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much a known defect stands out in one picture.
#pragma once

#include <optional>

#include "core/image/image.h"
#include "metrics/statistics/estimate.h"
#include "studies/inspect/inspect_truth.h"

namespace glint {

/// Mean of a defect's pixels over what light they would have without it, less 1. That light is the
/// quadratic in x and y that fits the pixels around best, 1.5 to 3 radii from the defect's line,
/// in the mean over the defect's pixels: neither a slope, nor a curvature, nor a part that ends
/// beside the defect is a contrast. The interval of 95 % is that of noise as the pixels around
/// have it about the fit, as alike up to 4 px apart as these are; the defect's own structure is no
/// noise.
/// @param region  the part's pixels; empty: all
/// @returns nothing where too few pixels of either are in the part, or no light is left there
std::optional<Estimate> defect_contrast(const ImageF& picture,
                                        const Mask& region,
                                        const KnownDefect& defect);

}  // namespace glint

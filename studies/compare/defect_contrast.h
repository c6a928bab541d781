// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much a known defect stands out in one picture.
#pragma once

#include <optional>

#include "core/image/image.h"
#include "metrics/statistics/estimate.h"
#include "studies/inspect/inspect_truth.h"

namespace glint {

/// (mean of a defect's pixels - mean of those around it) / mean of those around it, with an
/// interval of 95 % that takes neighbours for as alike as those around the defect are, up to 4 px
/// apart. Around is 1.5 to 3 radii from its line.
/// @param region  the part's pixels; empty: all
/// @returns nothing where too few pixels of either are in the part, or it is black around
std::optional<Estimate> defect_contrast(const ImageF& picture,
                                        const Mask& region,
                                        const KnownDefect& defect);

}  // namespace glint

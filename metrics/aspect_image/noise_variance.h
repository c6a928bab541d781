// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "metrics/aspect_image/homogeneity.h"

namespace glint {

/// Homogeneity as it is expected when each pixel of the aspect image scatters around its value with
/// a known standard deviation: h_rms and h_abs with the scatter of a normal number added, all else
/// as it was. For aspect images that were computed, not taken.
/// @param deviation  of the image's size, >= 0
Homogeneity with_noise_variance(const Homogeneity& homogeneity,
                                const ImageF& aspect,
                                const ImageF& deviation,
                                const Mask& region);

}  // namespace glint

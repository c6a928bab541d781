// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels whose grey values can be compared because no sensor's full scale cuts them off.
#pragma once

#include <cstddef>
#include <vector>

#include "core/image/image.h"

namespace glint {

struct UnclippedOptions {
  double full_scale = 1.0;  ///< > 0; grey at which the real picture is cut off
  /// >= 1; deviation of the real picture's noise before it was reduced over that of what is left
  /// between both pictures at one exposure
  double noise_over_rest = 1.0;
};

/// Pixels whose surroundings of 5 x 5 are below full scale in both pictures, at one exposure: by
/// two deviations of noise, at least by 0.02 and, as what is left between the pictures may be more
/// than noise, at most by 0.2. Were each pixel chosen by its own values, those near full scale that
/// noise made brighter would be missing, and the others would be too dark.
/// @param simulated, real  height x width each; what light makes, without a dark signal
/// @param shown            height x width; not 0: may be chosen
/// @return indices into values(), rising; none where these pixels of the simulated picture are
///         black
std::vector<std::size_t> unclipped_pixels(const ImageF& simulated,
                                          const ImageF& real,
                                          const Mask& shown,
                                          const UnclippedOptions& options);

}  // namespace glint

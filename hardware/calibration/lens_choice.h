// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which terms of the distortion a camera needs.
#pragma once

#include <cstdint>
#include <vector>

#include "hardware/calibration/bundle.h"
#include "hardware/calibration/camera_calibration.h"

namespace glint {

/// Folds of count items, folds[i] in [0, num_folds), equally large but for one, shuffled by seed.
std::vector<int> shuffled_folds(int count, int num_folds, std::uint64_t seed);

/// Tries no distortion, k1, k1 k2, k1 k2 k3, each without and with p1 p2: fitted to all folds but
/// one, each predicts the corners of the pictures left out, whose poses alone are fitted.
///
/// Taken is the choice with the fewest terms whose mean square is not larger than the best one's by
/// more than the standard error of that difference over the pictures. Lenses that fold within the
/// picture are left out.
/// @param bundle  free poses with their start; its mask says which terms may be free at all
/// @param choices  receives all that were tried
/// @return index in choices
std::size_t choose_lens_terms(const Bundle& bundle,
                              const CameraOptions& options,
                              std::vector<LensChoice>& choices);

}  // namespace glint

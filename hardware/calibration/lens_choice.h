// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which terms of the distortion a camera needs.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hardware/calibration/bundle.h"
#include "hardware/calibration/camera_calibration.h"

namespace glint {

/// Folds of count items, folds[i] in [0, num_folds), equally large but for one, shuffled by seed.
std::vector<int> shuffled_folds(int count, int num_folds, std::uint64_t seed);

/// The terms that may be estimated at all: those that are not known exactly and not left out.
LensMask allowed_terms(const CameraOptions& options);

/// What is known of the lens without being exact; empty when nothing is.
std::optional<LensPrior> prior_of(const CameraOptions& options);

/// Tries no distortion, k1, k1 k2, k1 k2 k3, each without and with p1 p2: fitted to all folds but
/// one, each predicts the corners of the pictures left out, whose poses alone are fitted.
///
/// Taken is the choice with the fewest terms whose mean square is not larger than the best one's by
/// more than the standard error of that difference over the pictures. Lenses that fold within the
/// picture are left out.
///
/// One fit with all terms, then everything by its linear system: a term that is left out is a
/// constraint, a picture that is left out a smaller sum. Where that is not exact (terms whose
/// absence costs many pixels) the choice is beyond doubt.
/// @param bundle  free poses with their start; its mask says which terms may be free at all
/// @param choices  receives all that were tried
/// @return index in choices
/// Cost: that of one fit.
std::size_t choose_lens_terms(const Bundle& bundle,
                              const CameraOptions& options,
                              std::vector<LensChoice>& choices);

/// Takes the choice: a term that is left out is zero, unless it is known and not to be estimated.
void take_lens_terms(Bundle& bundle, const LensMask& chosen);

}  // namespace glint

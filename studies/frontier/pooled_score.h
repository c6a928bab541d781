// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a score would be of a picture without noise, told from one picture that was made of
// independent batches of samples. Noise does not only scatter scores, it moves them: h of a grainy
// picture is lower. The jackknife takes that out (M. H. Quenouille, "Notes on bias in estimation",
// Biometrika 43, 1956): with B batches, u of all and u_b without one of them, B u - (B - 1) mean
// u_b has no error that falls as 1 / samples. Of scores that count a deviation d, u is d^2: a
// variance over pixels is quadratic in the batches' means, and its jackknife is the mean covariance
// of two different batches, exactly unbiased.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "studies/frontier/frontier.h"

namespace glint {

/// The score without noise and its standard error.
/// @param name         tells what the score counts: "homogeneity.h_rms"
/// @param whole        of all batches
/// @param without_one  two or more values, each without another batch
ReferenceScore pooled_score(const std::string& name,
                            double whole,
                            std::span<const double> without_one);

/// Frames as a single batch would show them if exposure were linear: B whole - (B - 1) without it.
/// @param whole, without  the same number of frames of one size
std::vector<ImageF> frames_of_batch(const std::vector<ImageF>& whole,
                                    const std::vector<ImageF>& without,
                                    std::size_t batches);

}  // namespace glint

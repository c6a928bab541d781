// SPDX-License-Identifier: GPL-3.0-or-later
//
// Detectability of a known signal in a correlated background: d'^2 = s^T K^-1 s.
#pragma once

#include <span>
#include <vector>

#include "metrics/statistics/estimate.h"

namespace glint {

/// d' of the ideal linear observer whose covariance is estimated from windows of the flawless
/// background, shrunk towards its diagonal (the idea of Ledoit and Wolf 2004; for this target
/// Schaefer and Strimmer 2005) so that it can be inverted.
///
/// Signal and covariance must come from different pictures, or d' is too high; with n windows of p
/// pixels the bias of the inverse is taken off (n - p - 2 over n - 1 where nothing was shrunk).
/// Takes some n p^2 + 10 p^3 operations. Infinite for a background that never varies.
///
/// @param signal      p pixels: mean with the defect minus mean without
/// @param background  at least two windows of p pixels
double dprime(std::span<const double> signal, std::span<const std::vector<double>> background);

}  // namespace glint

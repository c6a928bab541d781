// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a cheap figure puts things in the same order as a dear one.
#pragma once

#include <cstddef>
#include <span>

namespace glint {

struct RankAgreement {
  double tau = 0.0;               ///< Kendall's, in [-1, 1]; 0 without pairs
  std::size_t pairs = 0;          ///< that the reference can tell apart
  std::size_t winner = 0;         ///< the first of the smallest cheap figures
  double winner_behind = 0.0;     ///< its reference figure above the smallest one
  double winner_behind_se = 0.0;  ///< standard error of that difference
};

/// Kendall's tau (M. G. Kendall, "A new measure of rank correlation", Biometrika 30, 1938) over the
/// pairs whose reference figures differ by more than two standard errors of their difference.
/// Pairs that are equal in the cheap figure count as neither right nor wrong. Smaller is better.
/// @param cheap, reference  one figure of each thing, two or more, finite
/// @param reference_errors  their standard errors, >= 0
RankAgreement rank_agreement(std::span<const double> cheap,
                             std::span<const double> reference,
                             std::span<const double> reference_errors);

/// Tau at least `min_tau` over at least one pair, and the winner within two standard errors of the
/// best thing. Figures that the reference cannot tell apart show nothing: false.
bool is_ranking_right(const RankAgreement& agreement, double min_tau = 0.9);

}  // namespace glint

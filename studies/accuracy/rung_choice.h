// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which rung of a ladder of render settings serves, from scores of the same designs on every rung
// with the same random numbers. A decision on counted work: no clock has a say in it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "metrics/statistics/error_bound.h"
#include "metrics/statistics/rank_agreement.h"

namespace glint {

/// One rung as it was tried. The ladder's last rung is its top: what the others are compared with.
struct TriedRung {
  std::string name;
  double work = 0.0;                        ///< of one evaluation, > 0; the same unit on all rungs
  std::vector<std::vector<double>> scores;  ///< [score][design], finite, in the score's own unit
};

/// How wrong one score may be, in its own unit.
struct ScoreTolerance {
  std::string score;
  double tolerance = 0.0;  ///< > 0
};

struct RungChoice {
  std::optional<std::size_t> rung;  ///< the cheapest that serves, of equal ones the first
  /// Of each rung's scores against the top's, [rung][score]; the top's own are 0.
  std::vector<std::vector<ErrorBound>> bounds;
};

/// The cheapest rung whose bound of every score is at most its tolerance. The bound holds for the
/// share `confidence` of designs with that confidence; it knows nothing of the top's own error.
/// @param ladder      one rung or more, with the same scores of the same two or more designs
/// @param tolerances  one for each score, in the ladder's order
/// @param confidence  in (0, 1)
RungChoice choose_by_tolerance(std::span<const TriedRung> ladder,
                               std::span<const ScoreTolerance> tolerances,
                               double confidence);

/// Why no rung below the top serves, in one line a score: the smallest bound that is to be had,
/// and of which rung. Empty where every tolerance is reached by some rung below the top.
std::vector<std::string> unreached_tolerances(std::span<const TriedRung> ladder,
                                              std::span<const ScoreTolerance> tolerances,
                                              const RungChoice& choice);

/// How each rung orders the designs by what the search minimises, [rung], and the cheapest whose
/// order is right: Kendall's tau at least 0.9 and the winner within two standard errors of the
/// best. The top serves always.
struct OrderChoice {
  std::size_t rung = 0;
  std::vector<RankAgreement> agreements;
};

/// @param ladder      each rung with one score, what the search minimises
/// @param top_errors  standard errors of the top rung's figures, one a design
OrderChoice choose_by_order(std::span<const TriedRung> ladder, std::span<const double> top_errors);

}  // namespace glint

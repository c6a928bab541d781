// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the scores of a design spread when it is built as exactly as [manufacture] says, and which
// design is the best then.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/search/search.h"
#include "studies/tolerance/built_designs.h"

namespace glint {

using WriteVariables = std::function<nlohmann::ordered_json(const Point& point)>;

/// Evaluates the winner kToleranceDesigns times as a search would, its keys with tolerances moved
/// evenly within them (uniform, a Sobol sequence), all with the noise of the search (common random
/// numbers); and beside it designs that promise to be more robust, in the same way
/// (optimizer/robust/robust_optimum.h).
/// @param trials     of the search
/// @param winner     its best point
/// @param variables  writes a point as { path: value }
/// @param search     by what its answer was chosen, where scores are noisy or objectives several;
///                   without: by what the trials have shown
/// @return empty: interrupted; else
///         { designs, failed, distribution: "uniform", plus_minus: { key: number },
///           scores: { score: { nominal, mean, sd, low, high } } of objectives and limited ones,
///           low and high: 5 and 95 % of the designs,
///           feasible_share: of all, those that failed included; absent without limits,
///           robust: { is_winner, share: 0.95 of the built designs, measure: the score, of several
///             objectives the rule of the choice; winner, reached, gain: { value, low, high } of
///             what that share reaches, a bound null where a limit is the trouble; probability,
///             variables, failed, scores and feasible_share as above,
///             candidates: [ { variables, designs, modelled, reached, given_up } ] },
///           evaluations: of built designs, all together }
/// @throws IoError
std::optional<nlohmann::ordered_json> tolerance_spread(BuiltDesigns& designs,
                                                       const Study& study,
                                                       const std::vector<Trial>& trials,
                                                       const Point& winner,
                                                       const WriteVariables& variables,
                                                       const SearchResult& search = {});

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the scores of a design spread when it is built as exactly as [manufacture] says.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"

namespace glint {

/// Designs that are evaluated for it.
inline constexpr int kToleranceDesigns = 64;

/// Evaluates a point kToleranceDesigns times as a search would, its keys with tolerances moved
/// evenly within them (uniform, a Sobol sequence), all with the noise of the search (common random
/// numbers).
/// @return { designs, failed, distribution: "uniform", plus_minus: { key: number },
///           scores: { score: { nominal, mean, sd, low, high } } of objectives and limited ones,
///           low and high: 5 and 95 % of the designs,
///           feasible_share: of those that did not fail; absent without limits }
/// @throws IoError
nlohmann::ordered_json tolerance_spread(SceneStore& store, const Study& study, const Point& point);

/// The section of the report: one table. @param spread  of tolerance_spread()
nlohmann::ordered_json tolerance_panel(const nlohmann::ordered_json& spread);

}  // namespace glint

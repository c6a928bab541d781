// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much the noise of a scan moves the scores of a design.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "studies/evaluation/evaluation.h"

namespace glint {

/// How often a design is scored for it.
inline constexpr int kRepeatedScans = 8;

/// Scores a design kRepeatedScans times as a search would, each time with other noise; scan k of
/// every design has the same noise (common random numbers).
/// @param wanted  its trials are inspected with other parts each time
/// @param goal    whose scores are kept, beside the CNR of the worst defect
/// @return { score: [ values ] }; empty where a scan cannot be made
/// @throws IoError
nlohmann::ordered_json repeated_scores(SceneStore& store,
                                       const SceneSettings& scene,
                                       const WantedScores& wanted,
                                       const Goal& goal);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much the noise of a scan moves the scores of a design, and what other noise makes of a trial.
#pragma once

#include <functional>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/problem/trial.h"
#include "studies/accuracy/outcome_labels.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"

namespace glint {

/// How often a design is scored for it.
inline constexpr int kRepeatedScans = 8;

/// What is wanted of each of these scans. A search's finalists are many and its lines of parts
/// dear: there the trials have intervals.
WantedScores wanted_of_repeats(const Study& study);

/// Scan number `index` alone. @throws ConfigError where it cannot be made; IoError
Scores repeated_scan(SceneStore& store,
                     const SceneSettings& scene,
                     const WantedScores& wanted,
                     int index);

/// Gets what scan number `index` gave, when it was made.
using OnRepeatedScan = std::function<void(int index, const Outcome& outcome)>;

/// Scores a design kRepeatedScans times as a search would, each time with other noise; scan k of
/// every design has the same noise (common random numbers).
/// @param wanted   its trials are inspected with other parts each time
/// @param goal     whose scores are kept, beside the CNR of the worst defect
/// @param on_scan  gets all of each scan; empty: nobody does
/// @return { score: [ values ] }; empty where a scan cannot be made
/// @throws IoError
nlohmann::ordered_json repeated_scores(SceneStore& store,
                                       const SceneSettings& scene,
                                       const WantedScores& wanted,
                                       const Goal& goal,
                                       const OnRepeatedScan& on_scan = {});

/// A trial of a search re-scored with fresh noise and finer sampling.
/// @param fresh  gets what that gave; nullptr: nobody does
/// @return empty where the goal cannot be judged with what came out
/// @throws IoError
std::optional<Scores> rescored_trial(SceneStore& store,
                                     const Study& study,
                                     const Trial& trial,
                                     FreshOutcomes* fresh);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Probability of detection against size: parts with defects of one size after the other pass under
// each lighting, every one of them a hit or a miss at the same rate of false alarms.
#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/population_settings.h"
#include "studies/population/population_run.h"

namespace glint {

/// The group that a [pod] table looks for, with one size; nothing else on the part.
std::vector<NamedGroup> group_of_size(const PodSettings& settings,
                                      const std::vector<NamedGroup>& defects,
                                      double size_mm);

/// One part through the line: {"defects", "hits", "masked", "false_alarms"}. Masked defects lie
/// where the line does not look: they are missed whatever their size.
/// @param number  of the part; part `number` has the size of level number / settings.parts
Scores inspect_sized_part(const SimulatedLine& line,
                          const PodSettings& settings,
                          double threshold,
                          std::int64_t number);

/// Runs through all sizes at the study's own lighting and at each prototype's; writes pod.csv and
/// pod_curves.json.
/// @return the object `pod` of result.json (docs/populations.md); empty when interrupted
/// @throws ConfigError, IoError
std::optional<nlohmann::ordered_json> run_pod(const PopulationTask& task);

/// Seconds run_pod() will take, about.
double predicted_pod_s(const Study& study, SceneStore& store);

}  // namespace glint

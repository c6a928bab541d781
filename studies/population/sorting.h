// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sorting simulated parts into Perfect, Acceptable and Rejected, as section 4.2 of the first seed
// (Seulin, Merienne, Gorria 2002) sorts real ones: an expert grades each part, limits for the
// biggest defect and the sum of all are learned on one half of the parts and tested on the other.
#pragma once

#include <cstdint>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/study.h"
#include "studies/population/population_run.h"

namespace glint {

/// Sorts at the study's own lighting and at each prototype's; writes sorting.csv and
/// sorting_sizes.json.
/// @return the object `sorting` of result.json (docs/populations.md); empty when interrupted
/// @throws ConfigError, IoError
std::optional<nlohmann::ordered_json> run_sorting(const PopulationTask& task);

/// What run_sorting() inspects, at all its lightings together.
struct SortingCounts {
  std::int64_t parts = 0;
  std::int64_t flawless = 0;
};

SortingCounts sorting_counts(const Study& study);

/// Seconds run_sorting() will take, about.
double predicted_sorting_s(const Study& study, SceneStore& store);

}  // namespace glint

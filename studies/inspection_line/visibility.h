// SPDX-License-Identifier: GPL-3.0-or-later
//
// Visibility of defects in an inspection, as scores of a study: "inspection.detection_rate" and
// its kin, with intervals. Definitions: docs/theory/visibility_trials.md.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "metrics/scores.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// Whether a score comes from a simulated line: it begins with "inspection.".
bool is_of_line(std::string_view score);

/// The scores of an inspection that are asked for, each with its bounds ".low" and ".high". Runs
/// what they need and no more: a few hundred scans at worst. What cannot be measured is absent (no
/// defect was made, all sizes are found, too few parts for a bootstrap).
/// @param wanted  names, bounds too; those of other families are passed over
/// @param first   number of the first part: others give other parts and other noise
/// @throws ConfigError beginning with the key at fault, IoError
Scores visibility_scores(SceneStore& store,
                         const SceneSettings& scene,
                         std::span<const std::string> wanted,
                         std::int64_t first = 0);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint check`: what a study would do, and what is wrong with it, before anything is written.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// Builds the scene of the study and of each prototype.
/// @throws ConfigError for what cannot be built, with its place; IoError
void check_everything(SceneStore& store, const Study& study);

/// One evaluation of the baseline and of each prototype, and two for each variable to see whether
/// it acts; nothing written.
/// @return { schema, status, name, variables, insensitive_variables, baseline, prototypes,
/// evaluations,
///         seconds_per_evaluation, predicted_s }
nlohmann::ordered_json check_study(const Study& study, int threads, int jobs);

}  // namespace glint

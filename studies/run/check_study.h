// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint check`: what a study would do, and what is wrong with it, before anything is written.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// Builds the scene of the study and of each prototype.
/// @throws ConfigError for what cannot be built, with its place; IoError
void check_everything(SceneStore& store, const Study& study);

struct CheckOptions {
  int threads = 1;
  int jobs = 1;  ///< candidates at once, for the prediction
  Progress::Style progress = Progress::Style::kNone;
};

/// Begins the search, renders and re-scores the baseline, each prototype and the best design it
/// met, and evaluates both ends of each variable, to see whether it acts; nothing is kept on disk.
/// @return { schema, status, name, variables, objective, insensitive_variables (and, for readers of
///         older versions, the same as idle_variables), broken_limits, baseline, prototypes,
///         accuracy (accuracy_json() of a study with that table), evaluations, is_lower_bound (of
///         evaluations and CPU seconds, where the clock ends the search and there are more threads
///         than candidates at once), seconds_per_evaluation, predicted_cpu_s: { search, rescoring,
///         writing, populations, total; with [manufacture] manufacture }, predicted_s; with it
///         manufacture_evaluations: at most so many more }; seconds_per_evaluation is CPU time,
///         predicted_s the wall's on a machine that has nothing else to do; evaluations, search,
///         total and predicted_s are null where only budget.stall or budget.target ends the search
nlohmann::ordered_json check_study(const Study& study, const CheckOptions& options);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/study_search.h"

#include <filesystem>
#include <utility>

namespace glint {

SearchTask search_task(const Study& study, int jobs) {
  return {.space = study.space,
          .settings = study.search,
          .goal = study.goal,
          .budget = study.budget,
          .start_points = {baseline_point(study)},
          .jobs = jobs};
}

WantedScores wanted_in_search(const Study& study) {
  return needs_gradient(study.search.algorithm) ? wanted_with_gradients(study.goal, study.space)
                                                : wanted_by(study.goal);
}

Outcome evaluate_candidate(SceneStore& store, const Study& study, const Point& point) {
  const std::filesystem::path& file = study.scene.part.file;
  if (!file.empty() && !std::filesystem::exists(file)) {
    throw IoError(file.string() + ": has gone while the study was running");
  }
  Evaluation found =
      evaluate(store, scene_with(study, overrides_of(study, point)), {}, wanted_in_search(study));
  Outcome outcome;
  outcome.scores = std::move(found.scores);
  outcome.gradients = std::move(found.gradients.by_score);
  outcome.remarks = std::move(found.gradients.remarks);
  return outcome;
}

}  // namespace glint

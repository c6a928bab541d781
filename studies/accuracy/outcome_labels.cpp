// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/outcome_labels.h"

#include <cstdint>
#include <vector>

#include "studies/definition/render_methods.h"

namespace glint {
namespace {

/// @param fresh  the scene with other noise
std::uint64_t fresh_seed(const SceneSettings& scene, const SceneSettings& fresh) {
  const std::int64_t added = std::int64_t{fresh.sensor.seed} - scene.sensor.seed;
  return static_cast<std::uint64_t>(scene.paths.seed + added);
}

}  // namespace

OutcomeLabel searched_label(const Study& study, const std::string& rung) {
  return {.rung = rung, .seed = static_cast<std::uint64_t>(study.scene.paths.seed)};
}

OutcomeLabel rescored_label(const SceneSettings& scene) {
  return {
      .rung = kRescoredRung, .replicate = 1, .seed = fresh_seed(scene, rescoring_settings(scene))};
}

OutcomeLabel repeated_label(const SceneSettings& scene, int index) {
  return {.rung = kOwnRung,
          .replicate = index + 1,
          .seed = fresh_seed(scene, repeated_settings(scene, index))};
}

void FreshOutcomes::keep(const OutcomeLabel& label, int trial, const Outcome& outcome) {
  if (trial > 0) {
    storage_.record(std::vector<Replicate>{labelled(label, TrialKind::kSearch, trial, outcome)});
  }
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of one design in a run directory:
//
//   scene.toml  sequence/frame_000.png ...  aspect.png  aspect.exr  part_mask.png  defects.json
//   scores.json  cross_section.svg
//
// scores.json holds { title, role, trial, feasible, scores, rescored, variables, notes }.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/evaluation.h"

namespace glint {

/// Renders and scores a design, re-scores it with fresh seeds and finer sampling, and writes its
/// folder. @throws IoError, ConfigError
/// @param head  title, role, trial, feasible, variables: what only the caller knows
/// @return the object of scores.json
nlohmann::ordered_json write_design(SceneStore& store,
                                    const SceneSettings& scene,
                                    const nlohmann::ordered_json& head,
                                    const std::filesystem::path& folder,
                                    bool is_rescored);

/// The lighting, drawn to scale.
std::string draw_lighting(const SceneSettings& scene,
                          const BuiltPart& built,
                          const std::string& title);

/// Remarks on a scene that a reader of its numbers must know.
std::vector<std::string> scene_notes(const SceneSettings& scene, const Scores& scores);

/// Scores as a JSON object, in alphabetical order.
nlohmann::ordered_json scores_json(const Scores& scores);

}  // namespace glint

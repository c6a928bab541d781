// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which scores a scene has, known from its text alone: nothing is rendered for it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "studies/definition/scene.h"

namespace glint {

/// Labels of the scene's defects, in order.
std::vector<std::string> defect_labels(const SceneSettings& scene);

/// Names of the scene's groups of defects, in order.
std::vector<std::string> group_names(const SceneSettings& scene);

/// Why a score is no goal of any search; empty for nearly all.
std::string missing_as_goal(std::string_view score);

/// Why a scene with needs_paths() has no score of that name, for users who ask for it; empty when
/// it may have it, and for all other scenes.
std::string missing_by_paths(const SceneSettings& scene, std::string_view score);

/// Why the scene has no score of that name against real pictures; empty for all other scores, and
/// where [reference] names some.
std::string missing_by_reference(const SceneSettings& scene, std::string_view score);

/// Why the scene has no score of that name about an arm's reach; empty for all other scores, and
/// where [cell] names a file.
std::string missing_by_cell(const SceneSettings& scene, std::string_view score);

/// Why the scene has no score of that name about its lighting or [cost]; empty for all other
/// scores, and where it has it.
/// @param with_idle  whether lights that do not shine may come to
std::string missing_by_lighting(const SceneSettings& scene,
                                std::string_view score,
                                bool with_idle = false);

/// The first environment that shines, whose light comes from everywhere; empty: none does.
std::string shining_environment(const SceneSettings& scene);

}  // namespace glint

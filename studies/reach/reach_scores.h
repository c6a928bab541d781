// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "metrics/scores.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// "reach.share" and "reach.margin_mm" of metrics/scores.h: the views of the scene planned for the
/// arm of [cell] file. docs/plan.md
/// @throws ConfigError beginning with the key at fault, also without that file; IoError
Scores reach_scores(SceneStore& store, const SceneSettings& scene);

}  // namespace glint

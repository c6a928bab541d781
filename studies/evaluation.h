// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "metrics/scores.h"
#include "studies/traced_scene.h"

namespace glint {

/// One scene, scanned and scored.
struct Evaluation {
  Scores scores;
  ScanResult scan;
  std::shared_ptr<const TracedScene> traced;
  std::vector<DefectScores> defects;
};

/// Scans a scene and scores it. Single-threaded but for tracing rays.
/// @param consume  sees each frame's grey values in order; may be empty
/// @throws ConfigError beginning with the key at fault, IoError
Evaluation evaluate(SceneStore& store,
                    const SceneSettings& scene,
                    const FrameConsumer& consume = {});

/// The scene for re-scoring a finalist: other noise, and twice as many rays along each axis.
SceneSettings finer(SceneSettings scene);

/// Labels of the scene's defects, in order.
std::vector<std::string> defect_labels(const SceneSettings& scene);

}  // namespace glint

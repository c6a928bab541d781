// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives of a scene's scores by its keys, for searches that stand on gradients
// (docs/theory/derivatives.md).
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "optimizer/problem/trial.h"
#include "simulator/render/scan/closed_scan.h"
#include "simulator/render/wall/slot_margin.h"
#include "studies/imaging/traced_scene.h"

namespace glint {

/// Scores to differentiate, and by which keys of the scene.
struct WantedGradients {
  std::vector<std::string> scores;
  std::vector<std::string> paths;  ///< "lighting.tunnel.radius_mm"
};

struct Gradients {
  /// Score -> derivative by each path, in the unit the key is written in; NaN where there is none.
  /// Scores without derivatives are left out.
  std::map<std::string, std::vector<double>> by_score;
  /// Terms that are treated as constant and therefore missing, and keys without derivative.
  std::vector<Remark> remarks;
};

/// What a scan was made with, and what it gave.
struct ScanState {
  const TracedScene& traced;
  const Footprints& footprints;
  const Sensor& sensor;
  const ScanPlan& plan;
  std::shared_ptr<const PixelCells> cells;  ///< of the closed scan
  const ImageF& aspect;
  double sigma_floor = 0.0;
  SlotMargin slot;
  const ImageF* deviation = nullptr;  ///< of the pixels' scatter, if it is part of h
};

/// @throws ConfigError when the scan has no closed form
Gradients gradients_of(const SceneSettings& scene,
                       const ScanState& scan,
                       const WantedGradients& wanted,
                       ThreadPool& pool);

/// Why a score has no derivative by this key; empty when it has one.
std::string without_derivative(const SceneSettings& scene, const std::string& path);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frontier of a scene: what each method of rendering costs and how wrong it is. Everything is
// compared with 16 x 16 rays a pixel by plain sampling, without noise and quantisation, so that
// methods are compared and nothing else (docs/frontier.md).
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "studies/definition/scene.h"
#include "studies/frontier/frontier_errors.h"

namespace glint {

struct FrontierReference {
  ComparedMethod method;
  double h_rms = 0.0;
  std::map<std::string, double> weber;
  std::map<std::string, double> change;
  /// How wrong the reference's own frames are, extrapolated from 16 and 64 rays a pixel.
  std::optional<double> own_frame_rmse;
};

struct Frontier {
  FrontierReference reference;
  std::vector<FrontierPoint> points;
};

struct FrontierOptions {
  int threads = 1;  ///< for the reference; methods are measured with one
  int repeats = 3;  ///< of each warm candidate, at least; the best counts
  /// Called with the part of the work that is done, 0 to 1, and what comes next; may be empty.
  std::function<void(double done, const std::string& next)> on_progress;
};

/// Whether a point is as the reference but for its number of rays.
bool is_like_reference(const FrontierPoint& point, const Frontier& frontier);

/// Renders the scene by every method. @throws ConfigError beginning with the key at fault, IoError
Frontier measure_frontier(const SceneSettings& scene, const FrontierOptions& options);

}  // namespace glint

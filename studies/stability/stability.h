// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where methods fail: sweeps from harmless to hopeless, each cell judged (docs/stability.md).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/stability/stability_cell.h"

namespace glint::stability {

struct StabilityOptions {
  int threads = 1;
  Bounds bounds;
  /// A scene in place of the built-in one for all sweeps under a tunnel; its noise is left out and
  /// its camera has at most kMaxPixels.
  std::optional<ConfigNode> base = {};
  /// Called with the cells done and what comes next; false: no further cell is begun.
  std::function<bool(int done, const std::string& next)> on_progress = {};
};

struct SweepResult {
  Sweep sweep;
  std::vector<Cell> cells;  ///< fewer than the sweep's values when it was stopped
};

struct StabilityTotals {
  int right = 0;
  int told = 0;
  int refused = 0;
  int wrong = 0;
  int left_out = 0;
};

struct Stability {
  Bounds bounds;
  std::vector<SweepResult> sweeps;

  StabilityTotals totals() const;
};

/// Cells of all sweeps together.
int count_cells(const std::vector<Sweep>& sweeps);

/// @throws ConfigError when a given scene has what the reference does not model
Stability measure_stability(const std::vector<Sweep>& sweeps, const StabilityOptions& options);

/// The object of stability.json.
nlohmann::ordered_json stability_json(const Stability& stability);

}  // namespace glint::stability

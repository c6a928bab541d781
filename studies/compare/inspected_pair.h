// SPDX-License-Identifier: GPL-3.0-or-later
//
// The inspector on both sides of a pair whose simulated side knows its defects.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/thread_pool.h"
#include "metrics/statistics/estimate.h"
#include "studies/compare/compared_pair.h"
#include "studies/inspect/inspect_truth.h"

namespace glint {

/// A defect as one side shows it.
struct SeenDefect {
  bool is_found = false;
  bool is_beyond_picture = false;    ///< not found: its middle lies outside the picture
  std::string found_as;              ///< "hole" or "scratch"; empty: missed
  std::optional<Estimate> contrast;  ///< defect_contrast()
};

struct InspectedSide {
  int found = 0;
  int missed = 0;
  int false_alarms = 0;
  std::vector<SeenDefect> defects;  ///< as InspectedPair::known
};

/// How the simulated part's mask and its defects' places were moved before the photograph was
/// inspected there.
struct MovedPlace {
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< of the middle of its edges
  double turn_rad = 0.0;                               ///< about that, +x to +y (down)
  double scale = 1.0;
  double rest_px = 0.0;  ///< mean distance of the edges of both sides after that
  Eigen::Vector2d untold = Eigen::Vector2d::Zero();  ///< OutlineMotion::untold
};

struct InspectedPair {
  std::vector<KnownDefect> known;  ///< where the simulated picture has them
  InspectedSide simulated;
  InspectedSide real;
  std::optional<MovedPlace> moved;  ///< empty: the edges do not tell; inspected without
  std::vector<std::string> notes;
};

/// The photograph is inspected where its edges have the part: as the outline's motion as a whole
/// takes it there, or nearest edges do.
/// @returns nothing where the simulated side has no truth, or none of its defects is in view
/// @throws ConfigError, IoError
std::optional<InspectedPair> inspect_pair(const ComparedPair& pair, ThreadPool& pool);

}  // namespace glint

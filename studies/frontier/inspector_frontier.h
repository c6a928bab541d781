// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frontier of the inspection: which filter of which size finds how many defects at how many
// false reports, and what a picture costs it. Parts with defects drawn anew and flawless ones pass
// under the scene's light, each with noise of its own and the same for every setting
// (studies/inspection_line); thresholds are swept over multiples of the response's own noise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metrics/inspection/inspection_settings.h"
#include "metrics/statistics/estimate.h"
#include "studies/definition/scene.h"
#include "studies/frontier/frontier.h"

namespace glint {

/// What an inspection reports at one threshold.
struct DetectionPoint {
  double threshold = 0.0;  ///< of |response|, share of full scale
  double sigmas = 0.0;     ///< the same in the response's own noise; 0: it has none
  Estimate detected;       ///< share of the defects, with its interval
  Estimate false_reports;  ///< on a flawless picture
  int reports = 0;         ///< on all parts with defects, echoes left out, that are no defect
};

/// One way to inspect.
struct InspectorPoint {
  std::string label;  ///< "gaussian 31 px"
  InspectionSettings settings;
  bool is_current = false;      ///< the scene's own
  double region_share = 0.0;    ///< of the part, that it can look at
  std::optional<double> cpu_s;  ///< of one picture, one thread; absent where it needs the frames
  std::vector<DetectionPoint> curve;  ///< by rising threshold
  std::optional<DetectionPoint> own;  ///< at the scene's own rule for thresholds, of is_current
  /// The most defects that are found with no more false reports than the scene allows.
  std::optional<DetectionPoint> best;
  bool is_on_front = false;  ///< nothing that is not slower finds more at the allowed rate
  std::string problem;       ///< why it could not be measured
};

struct InspectorFrontier {
  int parts = 0;
  int flawless = 0;
  double allowed = 0.0;  ///< false reports a picture
  std::vector<InspectorPoint> points;
};

/// The scene's own setting first, then filters from small to large; labels are unique.
std::vector<InspectorPoint> compared_inspectors(const InspectionSettings& own);

/// Sets `best` and `is_on_front` of all points by their curves.
void mark_inspectors(double allowed, std::vector<InspectorPoint>& points);

/// The same bytes but for times, for any number of threads, where the budget leaves out nothing.
/// @param scene  with defects
/// @throws ConfigError beginning with the key at fault, IoError
InspectorFrontier measure_inspectors(const SceneSettings& scene, const FrontierOptions& options);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The trials behind the scores of an inspection: what a simulated line finds on its parts, and what
// on flawless ones. Definitions: docs/theory/visibility_trials.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "studies/inspection_line/simulated_line.h"

namespace glint {

/// What is to be measured; each costs scans of its own kind.
struct TrialNeeds {
  bool parts = false;     ///< parts with defects, inspected
  bool flawless = false;  ///< flawless parts, inspected
  bool largest = false;   ///< largest responses about the defects, and in the same places without
  bool dprime = false;    ///< matched filters
  bool smallest = false;  ///< parts scanned over and over with larger or smaller defects
};

/// What became of one defect.
struct DefectTrial {
  std::string group;
  double height_um = 0.0;  ///< depth or height; 0: a stain, which has none
  bool is_found = false;
  double signature = 0.0;        ///< area of its blobs / its true area; 0: missed
  double largest = 0.0;          ///< |response| near it; 0: masked
  double largest_without = 0.0;  ///< the same place on a flawless part
  RenderedEnergy rendering = {};
  /// Squared d', less what the noise alone has there: right on average, may be below 0.
  double squared_dprime = 0.0;
};

struct PartTrial {
  std::vector<DefectTrial> defects;
  /// Of `smallest`: the factor on all heights at which half of the part's defects are found;
  /// kMaxFactor where they never are.
  double factor = 0.0;
  /// Of `smallest`: how steep the part's defects that have a height are, made with that factor.
  std::vector<double> slopes_mrad;
};

struct LineTrials {
  static constexpr double kMaxFactor = 16.0;
  static constexpr double kMinFactor = 1.0 / 1024.0;

  double threshold = 0.0;
  double region_share = 0.0;
  double rendering_share = 0.0;  ///< SimulatedLine::rendering_share()
  std::vector<PartTrial> parts;
  std::int64_t false_alarms = 0;
  int flawless = 0;  ///< scans behind the false alarms
};

/// Runs the trials, several at once: the line is safe to call from several threads. The same bytes
/// for any number of threads.
/// @param first  number of the first part; other numbers are other parts and other noise
LineTrials run_trials(const SimulatedLine& line,
                      const TrialNeeds& needs,
                      std::int64_t first,
                      ThreadPool& pool);

}  // namespace glint

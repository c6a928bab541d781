// SPDX-License-Identifier: GPL-3.0-or-later
//
// The inspector on both sides of a pair whose simulated side knows its defects.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "metrics/statistics/estimate.h"
#include "studies/compare/compared_pair.h"
#include "studies/inspect/inspect_truth.h"

namespace glint {

/// A defect as one side shows it.
struct SeenDefect {
  bool is_found = false;
  std::string found_as;              ///< "hole" or "scratch"; empty: missed
  std::optional<Estimate> contrast;  ///< defect_contrast()
};

struct InspectedSide {
  int found = 0;
  int missed = 0;
  int false_alarms = 0;
  std::vector<SeenDefect> defects;  ///< as InspectedPair::known
};

struct InspectedPair {
  std::vector<KnownDefect> known;
  InspectedSide simulated;
  InspectedSide real;
  std::vector<std::string> notes;
};

/// @returns nothing where the simulated side has no truth, or none of its defects is in view
/// @throws ConfigError, IoError
std::optional<InspectedPair> inspect_pair(const ComparedPair& pair, ThreadPool& pool);

}  // namespace glint

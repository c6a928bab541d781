// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether designs stand in the same order on both sides.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "metrics/statistics/estimate.h"

namespace glint {

/// A design's objective in each of its views.
struct RankedDesign {
  std::string name;
  std::map<std::string, double> simulated = {};  ///< by view
  std::map<std::string, double> real = {};
  double simulated_error = 0.0;  ///< standard error of one view's value, where it is known
};

/// Two designs: positive differences are better ones of `first`.
struct RankedPair {
  std::string first;
  std::string second;
  Estimate simulated;  ///< difference of their means, with 95 %
  Estimate real;
  bool is_level = false;    ///< an interval holds 0: no order can be told on that side
  bool is_against = false;  ///< both sides tell an order, and not the same
};

struct Ranking {
  std::vector<std::string> simulated;  ///< names, the best first
  std::vector<std::string> real;
  std::vector<RankedPair> pairs;
  bool agrees = true;  ///< no pair is against
};

/// Differences are taken view by view where both designs have a view of that name. Without two of
/// these the interval is that of simulated_error on both sides, at least 2 % of the values.
Ranking rank_designs(const std::vector<RankedDesign>& designs, bool is_maximised);

/// The mean over its views.
double mean_of_views(const std::map<std::string, double>& values);

}  // namespace glint

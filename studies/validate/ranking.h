// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether designs stand in the same order on both sides.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "metrics/statistics/estimate.h"
#include "optimizer/problem/goal.h"
#include "studies/definition/study.h"
#include "studies/validate/both_scores.h"

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
  bool is_level = false;    ///< an interval holds 0, or no view is common: no order can be told
  bool is_against = false;  ///< both sides tell an order, and not the same
};

struct Ranking {
  std::vector<std::string> simulated;  ///< names, the best first
  std::vector<std::string> real;
  std::vector<RankedPair> pairs;
  bool agrees = true;  ///< no pair is against
};

/// Differences are taken view by view where both designs have a view of that name. Without three of
/// these the interval is that of simulated_error on both sides, at least 2 % of the values; without
/// any it has no bounds. Orders are those of the means over the views that all designs have; where
/// there is none, over each design's own.
Ranking rank_designs(const std::vector<RankedDesign>& designs, bool is_maximised);

/// The order by one objective, or why there is none.
struct ObjectiveRanking {
  std::string objective;
  bool is_maximised = true;
  std::optional<Ranking> ranking = {};
  std::string reason = {};  ///< of an empty ranking
};

/// Collects the objectives of a study view by view.
class RankingSheet {
 public:
  /// Without a study, or an objective in it, the scores that are told are homogeneity's, and no
  /// order is.
  explicit RankingSheet(const std::optional<Study>& study);

  /// The first one.
  const Objective& objective() const { return objectives_.front(); }

  void add(const std::string& design, const std::string& view, const BothScores& both);

  /// Of each objective. @param designs  how many have pictures
  std::vector<ObjectiveRanking> rankings(std::size_t designs) const;

 private:
  ObjectiveRanking ranking_by(std::size_t objective, std::size_t designs) const;

  std::vector<Objective> objectives_;
  std::string no_objective_;                        ///< why they are none of the study's
  std::vector<std::vector<RankedDesign>> designs_;  ///< of each objective, with both sides
};

/// What a verdict says of them, one sentence an objective, each with a space before it.
/// @param is_explained  no cause is left that would have to be set right first
std::string rankings_text(const std::vector<ObjectiveRanking>& rankings, bool is_explained);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How good the winner of a study's search is after how many evaluations: the search is run by
// several algorithms with several seeds, and the best design after 1, 2, 5, 10, ... evaluations is
// scored again as finalists are, with finer sampling and fresh random numbers, the same for all.
// Each search has a database of its own, in which a later call goes on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "studies/definition/study.h"

namespace glint {

/// The best design so far.
struct SearchStep {
  int evaluations = 0;
  std::optional<double> score;  ///< of the objective, as the search saw it; none succeeded: absent
  std::optional<double> top;    ///< scored again; absent where that failed or time was up
  bool is_feasible = false;     ///< of `top`
};

struct SearchRun {
  std::uint64_t seed = 0;
  int evaluations = 0;    ///< done, over all calls
  bool is_whole = false;  ///< it came to its own end rather than to that of the budget
  std::vector<SearchStep> steps;
};

/// Over the runs that came so far: of feasible winners, scored again.
struct SearchSummary {
  int evaluations = 0;
  int runs = 0;
  int feasible = 0;
  std::optional<double> median;
  std::optional<double> low;   ///< smallest
  std::optional<double> high;  ///< largest
};

struct SearchedMethod {
  std::string name;
  std::vector<SearchRun> runs;
  std::vector<SearchSummary> summary;
  std::string problem;  ///< why it cannot search this study
};

struct SearchFrontier {
  std::vector<SearchedMethod> methods;
  bool is_whole = true;  ///< every search came to its end and every winner was scored again
};

struct SearchFrontierOptions {
  std::filesystem::path folder;      ///< of the databases
  std::vector<std::string> methods;  ///< names of algorithms
  int seeds = 10;
  int threads = 1;
  double budget_s = 600.0;  ///< wall clock; a search that it cuts is gone on with by a later call
  std::function<void(double done, const std::string& next)> on_progress;
};

/// 1, 2, 5, 10, 20, 50, ... below `last`, and `last`.
std::vector<int> checkpoints_to(int last);

/// Of one method's runs, at each checkpoint that one of them reached.
std::vector<SearchSummary> summary_of(const std::vector<SearchRun>& runs);

/// @param study  with variables, one objective and a limit of evaluations
/// @throws ConfigError beginning with the key at fault, IoError
SearchFrontier measure_searches(const Study& study, const SearchFrontierOptions& options);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/search_frontier.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>

#include <fmt/format.h>

#include "core/error.h"
#include "core/median.h"
#include "optimizer/algorithm/algorithm.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/search/search.h"
#include "optimizer/storage/storage.h"
#include "studies/definition/render_methods.h"
#include "studies/definition/study_text.h"
#include "studies/evaluation/evaluation.h"
#include "studies/run/study_search.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSearchShare = 0.7;  ///< of the budget; winners are scored again in the rest

Study variant_of(const Study& study, const std::string& method, int seed) {
  Study variant = study;
  variant.search.algorithm = method;
  variant.search.seed = study.search.seed + static_cast<std::uint64_t>(seed);
  variant.budget.wall_clock_s = 0.0;
  variant.accuracy.reset();
  return variant;
}

/// Of a search as its folder knows it: earlier programs counted prototypes.
StudyIdentity identity_in(const std::filesystem::path& database, const Study& variant) {
  StudyIdentity identity = {.config_hash = config_hash(variant),
                            .config_text = resolved_text(variant),
                            .code_version = "",
                            .seed = variant.search.seed};
  if (std::filesystem::exists(database)) {
    const StudyIdentity recorded = Storage::read(database).identity();
    if (is_recorded_as(variant, recorded.config_hash, recorded.config_text)) {
      identity.config_hash = recorded.config_hash;
    }
  }
  return identity;
}

bool is_judgeable(const Goal& goal, const Trial& trial) {
  return trial.outcome && !trial.outcome->is_failed &&
         problem_with(goal, trial.outcome->scores).empty();
}

void check_searchable(const Study& study) {
  if (!study.has_search() || !study.has_objective) {
    throw ConfigError("variables", "a search chart needs [variables] and [objective]");
  }
  if (has_several_objectives(study.goal)) {
    throw ConfigError("objective",
                      "the search chart supports a single objective; this study has several");
  }
  if (study.budget.evaluations <= 0) {
    throw ConfigError("budget.evaluations", "is 0; a search chart needs a limit above 0");
  }
}

class SearchMeasuring {
 public:
  SearchMeasuring(const Study& study, const SearchFrontierOptions& options)
      : study_(study),
        options_(options),
        pool_(options.threads),
        store_(pool_),
        checkpoints_(checkpoints_to(study.budget.evaluations)) {
    for (const std::string& method : options.methods) {
      frontier_.methods.push_back({.name = method});
    }
    winners_.resize(options.methods.size());
  }

  SearchFrontier run() {
    for (int seed = 0; seed < options_.seeds; ++seed) {
      for (std::size_t m = 0; m < frontier_.methods.size(); ++m) {
        search_in_time(m, seed);
      }
    }
    score_again();
    for (SearchedMethod& method : frontier_.methods) {
      method.summary = summary_of(method.runs);
    }
    return std::move(frontier_);
  }

 private:
  using Winners = std::vector<std::optional<Point>>;  ///< at each step of a run

  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  void tell(double done, const std::string& next) const {
    if (options_.on_progress) {
      options_.on_progress(std::min(1.0, done), next);
    }
  }

  void search_in_time(std::size_t m, int seed) {
    SearchedMethod& method = frontier_.methods[m];
    if (!method.problem.empty()) {
      return;
    }
    const Study variant = variant_of(study_, method.name, seed);
    try {
      search(variant, m, fmt::format("{}, seed {}", method.name, variant.search.seed));
    } catch (const ConfigError& error) {
      method.problem = error.what();
    }
  }

  std::filesystem::path database_of(const Study& variant) const {
    return options_.folder /
           fmt::format("{}_{}.sqlite", variant.search.algorithm, variant.search.seed);
  }

  void search(const Study& variant, std::size_t m, const std::string& name) {
    const std::filesystem::path database = database_of(variant);
    Storage storage = Storage::open(database, identity_in(database, variant));
    std::atomic<int> interrupt = seconds() > kSearchShare * options_.budget_s ? 1 : 0;
    const auto watch = [&](const SearchProgress& /*progress*/) {
      ++evaluated_;
      tell(kSearchShare * evaluated_ / planned(), name);
      interrupt = seconds() > kSearchShare * options_.budget_s ? 1 : 0;
    };
    const SearchResult result = run_search(
        search_task(variant, 1),
        storage,
        [&](const Point& point, int /*trial*/) {
          return evaluate_candidate(store_, variant, point);
        },
        &interrupt,
        watch);
    evaluated_ += result.replayed;
    SearchRun run{.seed = variant.search.seed, .evaluations = result.evaluations};
    run.is_whole = result.termination != Termination::kInterrupted;
    frontier_.is_whole = frontier_.is_whole && run.is_whole;
    winners_[m].push_back(steps_of(storage.trials(TrialKind::kSearch), run));
    frontier_.methods[m].runs.push_back(std::move(run));
  }

  double planned() const {
    return static_cast<double>(options_.seeds) * static_cast<double>(options_.methods.size()) *
           study_.budget.evaluations;
  }

  /// A search that ended early, by a stall or a target, keeps its winner to the end.
  Winners steps_of(const std::vector<Trial>& trials, SearchRun& run) const {
    Winners winners;
    const Trial* best = nullptr;
    std::size_t next = 0;
    for (const int count : checkpoints_) {
      if (!run.is_whole && count > run.evaluations) {
        break;
      }
      for (; next < trials.size() && trials[next].number <= count; ++next) {
        const Trial& trial = trials[next];
        if (is_judgeable(study_.goal, trial) &&
            (best == nullptr ||
             is_better(study_.goal, trial.outcome->scores, best->outcome->scores))) {
          best = &trial;
        }
      }
      SearchStep step{.evaluations = count};
      if (best != nullptr) {
        step.score = best->outcome->scores.at(study_.goal.objective.name);
      }
      run.steps.push_back(step);
      winners.push_back(best != nullptr ? std::optional(best->point) : std::nullopt);
    }
    return winners;
  }

  /// From the last step back: what was found is worth more than how.
  void score_again() {
    for (std::size_t step = checkpoints_.size(); step-- > 0;) {
      for (std::size_t m = 0; m < winners_.size(); ++m) {
        for (std::size_t r = 0; r < winners_[m].size(); ++r) {
          if (step < winners_[m][r].size() && winners_[m][r][step]) {
            put_top(*winners_[m][r][step], frontier_.methods[m].runs[r].steps[step]);
          }
        }
      }
      const auto left = static_cast<double>(step) / static_cast<double>(checkpoints_.size());
      tell(1.0 - (1.0 - kSearchShare) * left, "winners scored again");
    }
  }

  void put_top(const Point& point, SearchStep& step) {
    auto found = rescored_.find(point);
    if (found == rescored_.end()) {
      if (seconds() > options_.budget_s && !rescored_.empty()) {
        frontier_.is_whole = false;
        return;
      }
      found = rescored_.emplace(point, rescored(point)).first;
    }
    if (found->second) {
      step.top = found->second->at(study_.goal.objective.name);
      step.is_feasible = is_feasible(study_.goal, *found->second);
    }
  }

  std::optional<Scores> rescored(const Point& point) {
    const WantedScores wanted = wanted_by(study_.goal).with_whole_scan(kFreshParts);
    try {
      const SceneSettings scene = scene_with(study_, overrides_of(study_, point));
      Scores scores = evaluate(store_, rescoring_settings(scene), {}, wanted).scores;
      return problem_with(study_.goal, scores).empty() ? std::optional(scores) : std::nullopt;
    } catch (const ConfigError&) {
      return std::nullopt;
    }
  }

  Clock::time_point start_ = Clock::now();
  const Study& study_;
  const SearchFrontierOptions& options_;
  ThreadPool pool_;
  SceneStore store_;
  std::vector<int> checkpoints_;
  double evaluated_ = 0.0;
  std::vector<std::vector<Winners>> winners_;  ///< of each method's runs
  std::map<Point, std::optional<Scores>> rescored_;
  SearchFrontier frontier_;
};

}  // namespace

std::vector<int> checkpoints_to(int last) {
  std::vector<int> list;
  for (int power = 1; power < last; power *= 10) {
    for (const int factor : {1, 2, 5}) {
      if (factor * power < last) {
        list.push_back(factor * power);
      }
    }
  }
  list.push_back(last);
  return list;
}

std::vector<SearchSummary> summary_of(const std::vector<SearchRun>& runs) {
  std::map<int, SearchSummary> summaries;
  std::map<int, std::vector<double>> values;
  for (const SearchRun& run : runs) {
    for (const SearchStep& step : run.steps) {
      SearchSummary& summary = summaries[step.evaluations];
      summary.evaluations = step.evaluations;
      ++summary.runs;
      if (step.top && step.is_feasible) {
        ++summary.feasible;
        values[step.evaluations].push_back(*step.top);
      }
    }
  }
  std::vector<SearchSummary> list;
  for (auto& [count, summary] : summaries) {
    if (const auto found = values.find(count); found != values.end()) {
      summary.median = median(found->second);
      summary.low = std::ranges::min(found->second);
      summary.high = std::ranges::max(found->second);
    }
    list.push_back(summary);
  }
  return list;
}

SearchFrontier measure_searches(const Study& study, const SearchFrontierOptions& options) {
  check_searchable(study);
  return SearchMeasuring(study, options).run();
}

}  // namespace glint

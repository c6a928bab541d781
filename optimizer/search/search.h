// SPDX-License-Identifier: GPL-3.0-or-later
//
// The loop of a study: ask, evaluate, record, tell, until the budget is spent.
//
// Everything that matters is in the storage before the next step depends on it, so a search killed
// at any moment goes on to the same result, bit for bit: the recorded events are replayed, each
// asked point is compared with the record, recorded outcomes are told again and only what is
// missing is evaluated. Events before the last epoch are history: replay begins with it. Outcomes
// are told in the order of asking, so results do not depend on how
// many evaluations run at once.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "optimizer/algorithm/algorithm.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/problem/exact_scores.h"
#include "optimizer/problem/space.h"
#include "optimizer/problem/trial.h"
#include "optimizer/search/expectations.h"
#include "optimizer/search/expected_limits.h"
#include "optimizer/search/trade_off.h"
#include "optimizer/storage/storage.h"

namespace glint {

/// When to stop; whatever comes first. All of it counts over resumes. At least one must be set.
struct Budget {
  int evaluations = 300;  ///< 0: no limit. Designs asked again cost nothing.
  /// Of searching, without the time between runs; 0: no limit. What the search or its epoch began
  /// with is evaluated in any case.
  double wall_clock_s = 0.0;
  /// Evaluations without a design that is better by more than its noise (is_surely_better()), of
  /// those that the search or its epoch did not begin with. With several objectives without one
  /// that adds to the hypervolume: that beats, in some objective and by more than noise, each
  /// design that added before, and adds more than the noise of what it adds (by rules 6). 0: no
  /// limit.
  int stall = 0;
  /// Objective that a feasible design has to reach; of one only. Of a noisy one the model has to
  /// expect it of the best design, where there is a model (by rules 6); it is asked when a design
  /// of the last batch was seen to reach it or the model has other parameters (by rules 7), and at
  /// once where the run goes on with another target (by rules 8).
  std::optional<double> target;
  /// Not of the search: designs that race with fresh random numbers when it has ended; 0: none.
  /// Empty: as many as race_size() says.
  std::optional<int> race;
};

enum class Termination {
  kEvaluations,
  kWallClock,
  kStall,
  kTarget,
  kInterrupted,
  kExhausted,  ///< every design of a finite space has been evaluated
  kFailures    ///< the first ten evaluations all failed
};

/// "evaluations", "wall_clock", "stall", "target", "interrupted", "exhausted", "failures"
std::string_view termination_name(Termination termination);

/// Whether the search has time left to evaluate designs again.
enum class TimeLeft { kSome, kNone };

/// Looks at a search between its batches: at all trials told so far, each with its outcome. Where
/// their scores turn out to be wrong it returns a kEpoch event: all outcomes are withdrawn, the
/// same points are asked first and evaluated again, and the algorithm begins anew with them. Must
/// follow from the trials and from what the caller keeps, so that a resumed search decides alike; a
/// review that is cut short by an interrupt returns nothing and is made again. So does one without
/// time left, which only looks: a resumed search with a larger budget of time begins the epoch.
using Review = std::function<std::optional<Event>(std::span<const Trial> told, TimeLeft left)>;

/// How a design is rendered and with which random numbers, when it is evaluated now. Called from
/// several threads when jobs > 1.
using LabelOf = std::function<OutcomeLabel(const Point& point)>;

/// What is searched, and how. All but budget, is_start_known, jobs, review and label belong into
/// the study's config hash.
struct SearchTask {
  SearchSpace space;
  SearchSettings settings;
  Goal goal;
  Budget budget;
  std::vector<Point> start_points;  ///< evaluated first, in order
  /// Start points are trials of an earlier run, whose outcomes are known (but for the baseline's,
  /// perhaps): all of them are told before stall, target or time can end the search.
  bool is_start_known = false;
  int jobs = 1;            ///< evaluations at once; more than settings.batch has no use
  ExactScores exact = {};  ///< what follows from a design alone
  std::vector<std::string> steady = {};  ///< limited scores that noise does not move
  /// Compute every recorded ask again and compare it; false: of methods whose state follows from
  /// the record alone the last batch and some drawn ones.
  bool verify_replay = false;
  Review review = {};  ///< empty: there is one epoch
  /// Each outcome is recorded as a replicate, too, which stays when an epoch withdraws it. Empty:
  /// none is.
  LabelOf label = {};
};

/// Evaluates one design. Called from several threads when jobs > 1. What it throws as glint::Error
/// becomes a failed trial with that message, except IoError, which ends the run (resumable); scores
/// that cannot be judged do so too, and, where needs_gradient(algorithm), outcomes without the
/// derivatives that problem_with_gradients() asks for. The seconds of the outcome are filled in by
/// the search.
using Evaluate = std::function<Outcome(const Point& point, int trial)>;

/// Thrown by an Evaluate that gives up because of a second interrupt: nothing is recorded and the
/// design is evaluated again when the search is resumed.
class EvaluationAborted : public Error {
 public:
  EvaluationAborted() : Error("evaluation aborted") {}
};

/// State after an evaluation was recorded, for display.
struct SearchProgress {
  int evaluations = 0;  ///< so far, over all runs
  int failed = 0;
  double seconds = 0.0;  ///< searched so far, over all runs
  Trial last;
  /// As in SearchResult, but of what is evaluated so far, in any order.
  std::optional<Trial> best;
  int on_front = 0;  ///< of several objectives: designs that no other one beats in everything
};

/// Called after each evaluation, one call at a time, possibly from another thread.
using OnEvaluation = std::function<void(const SearchProgress&)>;

/// By what the limits of a search's answer are judged under noise.
struct JudgedLimits {
  ExpectedLimits expected;
  bool is_raced = false;  ///< by the replicates of a race of finalists, else by the search's models
};

struct SearchResult {
  Termination termination = Termination::kEvaluations;
  /// The best feasible design, of several objectives the compromise that the goal's choice takes;
  /// else the one with the least violation or, where models judge limits, the one that keeps them
  /// most probably; empty: none succeeded.
  std::optional<Trial> best;
  /// Of best: whether it was seen to keep the limits; where models or replicates judge them,
  /// whether it does so with a probability of a half or more.
  bool is_feasible = false;
  int evaluations = 0;  ///< over all runs, failed ones included
  int failed = 0;
  int reused = 0;            ///< times the algorithm asked for a design it already knew
  int replayed = 0;          ///< evaluations that were found recorded when this run began
  int target_questions = 0;  ///< times that a model was asked whether the target is expected
  double seconds = 0.0;
  std::string algorithm;  ///< the name that `auto` stood for
  /// Runs of the algorithm that had to be abandoned; derivatives that are not used; a reference
  /// that lies inside the front; a target that was reached by noise.
  std::vector<std::string> warnings;
  std::optional<TradeOff> trade_off;  ///< of several objectives
  Expectations expected = {};         ///< where scores are noisy and the algorithm has models
  LimitExpectations limits = {};      ///< the same of limits (by rules 8, under search.noisy)
  std::optional<JudgedLimits> judged_limits = {};  ///< of best, where limits have such
  int rules = kSearchRules;                        ///< that it followed, SearchSettings::rules

  /// What the front is made of; empty: of what was seen.
  Expectations of_front() const {
    return trade_off && trade_off->is_expected ? expected : Expectations{};
  }
};

/// @param interrupt  nullptr, or how often the user interrupted: at 1 the running evaluations
///                   finish and no more begin; at 2 an Evaluate should throw EvaluationAborted
/// @throws ConfigError  for a wrong task; when the record cannot be replayed because program,
///                      library or machine changed
/// @throws IoError      when the storage cannot be written or is damaged
SearchResult run_search(const SearchTask& task,
                        Storage& storage,
                        const Evaluate& evaluate,
                        const std::atomic<int>* interrupt = nullptr,
                        const OnEvaluation& on_evaluation = {});

}  // namespace glint

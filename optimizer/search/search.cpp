// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/search.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <mutex>
#include <utility>

#include "core/jobs.h"
#include "core/wall_clock.h"
#include "optimizer/front/front.h"
#include "optimizer/search/replay.h"
#include "optimizer/search/task_check.h"

namespace glint {

namespace {

using Clock = std::chrono::steady_clock;

/// Asks for known designs in a row after which nothing new is to be expected.
constexpr int kMaxIdleAsks = 1000;
/// A study whose first evaluations all fail is set up wrongly.
constexpr int kMaxFirstFailures = 10;

class Search {
 public:
  Search(const SearchTask& task,
         Storage& storage,
         const Evaluate& evaluate,
         const std::atomic<int>* interrupt,
         const OnEvaluation& on_evaluation)
      : task_(task),
        storage_(storage),
        evaluate_(evaluate),
        interrupt_(interrupt),
        on_evaluation_(on_evaluation),
        memory_(make_memory(task, storage)) {}

  SearchResult run() {
    begin_log(task_, storage_);
    replay(task_, storage_, memory_);
    const std::vector<Event> log = storage_.events();
    std::ranges::for_each(last_epoch(log), [this](const Event& event) { look_at(event); });
    seconds_before_ = storage_.total_seconds();
    for (const Trial& trial : memory_.trials) {
      count(trial);
    }
    result_.replayed = result_.evaluations;
    result_.termination = loop();
    storage_.set_session_seconds(seconds_since(start_));
    return finished_result();
  }

 private:
  /// Keeps what the user is told of it.
  void look_at(const Event& event) {
    if (event.kind == EventKind::kAbandon) {
      result_.warnings.push_back(event.text);
    } else if (event.kind == EventKind::kNote && event.value == 0.0 && task_.settings.derivatives) {
      on_derivatives_ = event.text;
    }
  }

  Termination loop() {
    while (true) {
      if (memory_.in_flight.empty()) {
        if (begins_epoch()) {
          continue;
        }
        if (const std::optional<Termination> end = ended()) {
          return *end;
        }
        if (!ask_batch()) {
          return Termination::kExhausted;
        }
      }
      if (const std::optional<Termination> end = evaluate_in_flight()) {
        return *end;
      }
      tell_in_flight();
    }
  }

  /// Lets the caller review what is told.
  bool begins_epoch() {
    if (!task_.review || is_interrupted()) {
      return false;
    }
    const auto told = static_cast<std::size_t>(memory_.num_told);
    const std::optional<Event> event = task_.review(std::span(memory_.trials).first(told));
    if (!event) {
      return false;
    }
    storage_.begin_epoch(*event);
    memory_ = make_memory(task_, storage_);
    replay(task_, storage_, memory_);
    result_ = {.replayed = result_.replayed};
    on_derivatives_.clear();
    shown_best_.reset();
    shown_front_.clear();
    return true;
  }

  bool is_interrupted() const { return interrupt_ != nullptr && interrupt_->load() > 0; }

  bool is_out_of_time() const {
    const double limit = task_.budget.wall_clock_s;
    return limit > 0.0 && seconds_before_ + seconds_since(start_) >= limit;
  }

  bool reaches_target(double value) const {
    const double target = *task_.budget.target;
    return task_.goal.objective.is_maximised ? value >= target : value <= target;
  }

  /// As it was seen.
  bool reaches_target(const Trial& told) const {
    return !told.outcome->is_failed && is_feasible(task_.goal, told.outcome->scores) &&
           reaches_target(told.outcome->scores.at(task_.goal.objective.name));
  }

  bool has_reached_target() {
    if (!task_.budget.target || !memory_.best || !reaches_target(trial(*memory_.best))) {
      return false;
    }
    return !task_.settings.is_noisy || task_.settings.rules < 6 ||
           (may_expect_target() && is_target_expected());
  }

  /// Whether the model can have come to expect the target by the last batch: one of its designs was
  /// seen to reach it, or the model has other parameters. By rules 6 it is asked after every batch.
  /// Follows from the log, so that a search that was cut up ends where a whole one does.
  bool may_expect_target() const {
    const auto batch = std::span(memory_.tells).subspan(memory_.told_before_batch);
    return task_.settings.rules < 7 || algorithm_name() != "gp" || memory_.has_new_model() ||
           std::ranges::any_of(batch, [this](int n) { return reaches_target(trial(n)); });
  }

  /// Whether the model expects it of the best design, which one lucky evaluation does not make; of
  /// methods without models nothing else is known.
  bool is_target_expected() {
    ++result_.target_questions;
    const std::vector<std::vector<Expectation>> rows = memory_.algorithm->expected_objectives();
    const auto best = expected_best(task_.goal, memory_.trials, memory_.tells, rows);
    return best ? expects_target(expectations_of(task_.goal, memory_.tells, rows), *best)
                : algorithm_name() != "gp";
  }

  bool expects_target(const Expectations& expected, int number) const {
    const auto found = expected.find(number);
    return found != expected.end() && reaches_target(found->second.front().mean);
  }

  /// Looked at between batches only, so that it does not depend on jobs or interruptions.
  std::optional<Termination> ended() {
    const Budget& budget = task_.budget;
    if (task_.review && is_interrupted()) {
      return Termination::kInterrupted;  // its end is to be reviewed, too
    }
    if (has_reached_target()) {
      return Termination::kTarget;
    }
    if (memory_.num_told >= kMaxFirstFailures && memory_.num_failed == memory_.num_told) {
      return Termination::kFailures;
    }
    if (budget.evaluations > 0 && memory_.num_told >= budget.evaluations) {
      return Termination::kEvaluations;
    }
    if (budget.stall > 0 && memory_.since_better >= budget.stall) {
      return Termination::kStall;
    }
    if (memory_.num_idle >= kMaxIdleAsks + memory_.num_archived) {
      return Termination::kExhausted;
    }
    if (is_interrupted()) {
      return Termination::kInterrupted;
    }
    if (is_out_of_time()) {
      return Termination::kWallClock;
    }
    return std::nullopt;
  }

  /// Always a whole batch, also when the budget holds fewer evaluations: a search that is given a
  /// larger budget later must have asked the same.
  bool ask_batch() {
    std::vector<Event> events;
    std::vector<Trial> new_trials;
    for (int i = 0; i < task_.settings.batch; ++i) {
      const std::optional<Point> point = memory_.algorithm->ask();
      for (Event& event : memory_.algorithm->take_events()) {
        look_at(event);
        if (event.kind == EventKind::kModel) {
          memory_.note_model();
        }
        events.push_back(std::move(event));
      }
      if (!point) {
        break;
      }
      const auto next = static_cast<int>(memory_.trials.size()) + 1;
      const auto [it, is_new] = memory_.number_of.try_emplace(*point, next);
      if (is_new) {
        memory_.trials.push_back({.number = next, .point = *point});
        new_trials.push_back(memory_.trials.back());
      }
      memory_.note_ask(it->second);
      events.push_back({.kind = EventKind::kAsk, .trial = it->second});
    }
    storage_.append(events, new_trials);
    return !memory_.in_flight.empty();
  }

  /// Evaluates what is asked and has no outcome. Empty when all of it has one afterwards.
  std::optional<Termination> evaluate_in_flight() {
    std::vector<int> missing;
    for (const int number : memory_.in_flight) {
      if (!trial(number).outcome && std::ranges::find(missing, number) == missing.end()) {
        missing.push_back(number);
      }
    }
    const std::size_t num_missing = missing.size();
    const int limit = task_.budget.evaluations;
    if (limit > 0) {
      const int left = std::max(0, limit - result_.evaluations);
      missing.resize(std::min(num_missing, static_cast<std::size_t>(left)));
    }
    evaluate_all(missing);
    if (!std::ranges::all_of(missing, [this](int n) { return trial(n).outcome.has_value(); })) {
      return is_interrupted() || !is_out_of_time() ? Termination::kInterrupted
                                                   : Termination::kWallClock;
    }
    return missing.size() < num_missing ? std::optional(Termination::kEvaluations) : std::nullopt;
  }

  void evaluate_all(const std::vector<int>& numbers) {
    run_jobs(
        numbers.size(),
        task_.jobs,
        [&](std::size_t i) { evaluate_one(numbers[i]); },
        [&] { return is_interrupted() || is_out_of_time(); });
  }

  void evaluate_one(int number) {
    const auto start = Clock::now();
    Outcome outcome;
    try {
      outcome = evaluate_(trial(number).point, number);
    } catch (const EvaluationAborted&) {
      return;
    } catch (const IoError&) {
      throw;  // a full disk or a file that went away says nothing about the design
    } catch (const Error& error) {
      outcome = {.is_failed = true, .message = error.what()};
    }
    outcome.seconds = seconds_since(start);
    make_storable(outcome);
    fail_unusable(trial(number).point, outcome);
    storage_.record(TrialKind::kSearch, number, outcome);
    const std::lock_guard lock(mutex_);
    trial(number).outcome = std::move(outcome);
    count(trial(number));
    report(trial(number));
  }

  void fail_unusable(const Point& point, Outcome& outcome) const {
    const std::string problem =
        outcome.is_failed ? "" : problem_with_outcome(task_, point, outcome);
    if (!problem.empty()) {
      outcome.is_failed = true;
      outcome.message = problem;
    }
  }

  void count(const Trial& evaluated) {
    if (!evaluated.outcome) {
      return;
    }
    ++result_.evaluations;
    result_.failed += evaluated.outcome->is_failed ? 1 : 0;
    if (evaluated.outcome->is_failed) {
      return;
    }
    if (has_several_objectives(task_.goal) && is_feasible(task_.goal, evaluated.outcome->scores)) {
      count_on_front(evaluated.number);
    } else if (shown_front_.empty() &&
               (!shown_best_ ||
                is_better(
                    task_.goal, evaluated.outcome->scores, trial(*shown_best_).outcome->scores))) {
      shown_best_ = evaluated.number;
    }
  }

  void count_on_front(int number) {
    shown_front_.push_back(number);
    std::vector<std::vector<double>> rows;
    for (const int shown : shown_front_) {
      rows.push_back(minimised_objectives(task_.goal, trial(shown).outcome->scores));
    }
    std::vector<int> kept;
    std::vector<std::vector<double>> front;
    for (const std::size_t row : front_of(rows)) {
      kept.push_back(shown_front_[row]);
      front.push_back(rows[row]);
    }
    shown_front_ = std::move(kept);
    shown_best_ = shown_front_[compromise_of(front, front_choice_of(task_.goal))];
  }

  void report(const Trial& last) const {
    if (!on_evaluation_) {
      return;
    }
    SearchProgress state{.evaluations = result_.evaluations,
                         .failed = result_.failed,
                         .seconds = seconds_before_ + seconds_since(start_),
                         .last = last};
    state.best = shown_best_ ? std::optional(trial(*shown_best_)) : std::nullopt;
    state.on_front = static_cast<int>(shown_front_.size());
    on_evaluation_(state);
  }

  void tell_in_flight() {
    std::vector<Event> events;
    while (!memory_.in_flight.empty()) {
      events.push_back(memory_.tell_next(task_.goal));
      if (auto fixed = memory_.fix_reference(task_.goal)) {
        events.push_back(std::move(*fixed));
      }
    }
    storage_.append(events);
    storage_.set_session_seconds(seconds_since(start_));
  }

  SearchResult finished_result() {
    SearchResult result = std::move(result_);
    result.algorithm = algorithm_name();
    result.rules = task_.settings.rules;
    if (!on_derivatives_.empty()) {
      result.warnings.push_back(on_derivatives_);
    }
    result.reused = memory_.num_reused;
    result.seconds = seconds_before_ + seconds_since(start_);
    result.best = best_seen(task_.goal, memory_.trials);
    const std::vector<std::vector<Expectation>> expected = expected_rows();
    result.expected = expectations_of(task_.goal, memory_.tells, expected);
    if (has_several_objectives(task_.goal)) {
      take_compromise(result);
    } else if (task_.settings.is_noisy && task_.settings.rules > 1) {
      const std::optional<int> best =
          expected_best(task_.goal, memory_.trials, memory_.tells, expected);
      result.best = best ? trial(*best) : result.best;
    }
    result.is_feasible = result.best && is_feasible(task_.goal, result.best->outcome->scores);
    note_lucky_target(result);
    return result;
  }

  void note_lucky_target(SearchResult& result) const {
    if (result.termination == Termination::kTarget && task_.settings.is_noisy &&
        !expects_target(result.expected, result.best->number)) {
      result.warnings.push_back(
          std::string("budget.target was reached by an evaluation with noise; ") +
          (result.expected.empty() ? "whether the winner reaches it without is not known"
                                   : "that the winner reaches it without is not expected"));
    }
  }

  /// One per tell; empty where scores are not noisy.
  std::vector<std::vector<Expectation>> expected_rows() {
    const bool is_noisy = task_.settings.is_noisy || tells_noise(task_.goal, memory_.trials);
    return is_noisy && task_.settings.rules > 1 ? memory_.algorithm->expected_objectives()
                                                : std::vector<std::vector<Expectation>>{};
  }

  std::string algorithm_name() const {
    return resolved_algorithm(task_.space, task_.settings, num_objectives(task_.goal));
  }

  /// By rules 7 of what noisy scores are expected to be, where a model knows.
  void take_compromise(SearchResult& result) const {
    const Goal& goal = task_.goal;
    const bool is_expected = task_.settings.is_noisy && task_.settings.rules > 6;
    if (is_expected) {
      result.expected =
          with_exact_scores(goal, memory_.trials, task_.exact.names, std::move(result.expected));
    }
    result.trade_off = trade_off(
        goal, memory_.trials, memory_.reference, is_expected ? result.expected : Expectations{});
    if (result.trade_off->trials.empty()) {  // what meets the limits was not told before the end
      result.trade_off = trade_off(goal, memory_.trials, memory_.reference);
    }
    const TradeOff& found = *result.trade_off;
    if (!found.trials.empty()) {
      result.best = trial(found.trials[found.chosen]);
    }
    if (found.outside > 0) {
      result.warnings.push_back(
          "the reference lies inside the front: " + std::to_string(found.outside) + " of its " +
          std::to_string(found.front.size()) +
          " designs are not better than it in every objective and add nothing to the hypervolume");
    }
  }

  Trial& trial(int number) { return memory_.trial(number); }

  const Trial& trial(int number) const {
    return memory_.trials[static_cast<std::size_t>(number - 1)];
  }

  const SearchTask& task_;
  Storage& storage_;
  const Evaluate& evaluate_;
  const std::atomic<int>* interrupt_;
  const OnEvaluation& on_evaluation_;
  SearchMemory memory_;
  std::mutex mutex_;
  SearchResult result_;
  std::string on_derivatives_;     ///< the last that was let go of them
  std::optional<int> shown_best_;  ///< best of all evaluated, told or not
  std::vector<int> shown_front_;   ///< of several objectives
  double seconds_before_ = 0.0;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

std::string_view termination_name(Termination termination) {
  constexpr std::array<std::string_view, 7> kNames = {
      "evaluations", "wall_clock", "stall", "target", "interrupted", "exhausted", "failures"};
  return kNames[static_cast<std::size_t>(termination)];
}

SearchResult run_search(const SearchTask& task,
                        Storage& storage,
                        const Evaluate& evaluate,
                        const std::atomic<int>* interrupt,
                        const OnEvaluation& on_evaluation) {
  check_task(task);
  SearchTask ruled = task;
  ruled.settings.rules = recorded_rules(storage.events(), task.settings.rules);
  return Search(ruled, storage, evaluate, interrupt, on_evaluation).run();
}

}  // namespace glint

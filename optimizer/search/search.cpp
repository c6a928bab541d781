// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/search.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <mutex>
#include <utility>

#include "core/jobs.h"
#include "core/wall_clock.h"
#include "optimizer/search/best_so_far.h"
#include "optimizer/search/replay.h"
#include "optimizer/search/search_answer.h"
#include "optimizer/search/search_target.h"
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
        memory_(make_memory(task, storage)),
        target_(task, storage.events()),
        shown_(task.goal) {}

  SearchResult run() {
    begin_log(task_, storage_);
    replay(task_, storage_, memory_);
    label_recorded();
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
    } else if (event.kind == EventKind::kNote && event.value == 0.0 && event.objectives.empty() &&
               task_.settings.derivatives) {
      on_derivatives_ = event.text;
    }
  }

  Termination loop() {
    if (knows_new_target()) {
      return Termination::kTarget;
    }
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

  /// Whether a target that a run goes on with is reached by what was told before the batch that it
  /// was stopped in; without such a batch ended() looks at it, and a review of outcomes comes
  /// first.
  bool knows_new_target() {
    return target_.is_new() && !memory_.in_flight.empty() && !task_.review &&
           target_.is_reached(memory_);
  }

  /// Lets the caller review what is told.
  bool begins_epoch() {
    if (!task_.review || is_interrupted()) {
      return false;
    }
    const auto told = static_cast<std::size_t>(memory_.num_told);
    const TimeLeft left = is_out_of_time() ? TimeLeft::kNone : TimeLeft::kSome;
    const std::optional<Event> event = task_.review(std::span(memory_.trials).first(told), left);
    if (!event) {
      return false;
    }
    storage_.begin_epoch(*event);
    memory_ = make_memory(task_, storage_);
    replay(task_, storage_, memory_);
    result_ = {.replayed = result_.replayed};
    on_derivatives_.clear();
    shown_ = BestSoFar(task_.goal);
    return true;
  }

  bool is_interrupted() const { return interrupt_ != nullptr && interrupt_->load() > 0; }

  /// Not before all is told that the search or its epoch began with: the best may be among it.
  bool is_out_of_time() const {
    const double limit = task_.budget.wall_clock_s;
    return limit > 0.0 && memory_.is_new(memory_.num_told + 1) &&
           seconds_before_ + seconds_since(start_) >= limit;
  }

  /// Looked at between batches only, so that it does not depend on jobs or interruptions.
  std::optional<Termination> ended() {
    const Budget& budget = task_.budget;
    if (task_.review && is_interrupted()) {
      return Termination::kInterrupted;  // its end is to be reviewed, too
    }
    if (target_.is_reached(memory_)) {
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
    if (std::optional<Event> target = target_.take_event()) {
      events.push_back(*std::move(target));
    }
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
    storage_.record(TrialKind::kSearch, number, outcome, labelled_outcome(trial(number), outcome));
    const std::lock_guard lock(mutex_);
    trial(number).outcome = std::move(outcome);
    count(trial(number));
    report(trial(number));
  }

  /// The outcome under the label that the task gives it; nothing where it gives none.
  std::vector<Replicate> labelled_outcome(const Trial& evaluated, const Outcome& outcome) const {
    std::vector<Replicate> replicates;
    if (task_.label) {
      replicates.push_back(
          labelled(task_.label(evaluated.point), evaluated.kind, evaluated.number, outcome));
    }
    return replicates;
  }

  /// What programs before recorded without labels.
  void label_recorded() {
    std::vector<Replicate> replicates;
    for (const Trial& known : memory_.trials) {
      if (known.outcome) {
        std::ranges::move(labelled_outcome(known, *known.outcome), std::back_inserter(replicates));
      }
    }
    storage_.record_missing(replicates);
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
    if (!evaluated.outcome->is_failed) {
      shown_.add(evaluated.number, evaluated.outcome->scores);
    }
  }

  void report(const Trial& last) const {
    if (!on_evaluation_) {
      return;
    }
    SearchProgress state{.evaluations = result_.evaluations,
                         .failed = result_.failed,
                         .seconds = seconds_before_ + seconds_since(start_),
                         .last = last};
    state.best = shown_.number() ? std::optional(trial(*shown_.number())) : std::nullopt;
    state.on_front = shown_.on_front();
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
    result.algorithm = algorithm_of(task_);
    result.rules = task_.settings.rules;
    if (!on_derivatives_.empty()) {
      result.warnings.push_back(on_derivatives_);
    }
    result.reused = memory_.num_reused;
    result.seconds = seconds_before_ + seconds_since(start_);
    take_answer(task_, memory_, result);
    result.target_questions = target_.num_questions();
    note_lucky_target(result);
    return result;
  }

  void note_lucky_target(SearchResult& result) const {
    if (result.termination == Termination::kTarget && task_.settings.is_noisy &&
        !target_.is_expected(result.expected, result.best->number)) {
      result.warnings.push_back(
          std::string("budget.target was reached by an evaluation with noise; ") +
          (result.expected.empty() ? "whether the winner reaches it without is not known"
                                   : "that the winner reaches it without is not expected"));
    }
  }

  Trial& trial(int number) { return memory_.trial(number); }

  const Trial& trial(int number) const { return memory_.trial(number); }

  const SearchTask& task_;
  Storage& storage_;
  const Evaluate& evaluate_;
  const std::atomic<int>* interrupt_;
  const OnEvaluation& on_evaluation_;
  SearchMemory memory_;
  SearchTarget target_;
  std::mutex mutex_;
  SearchResult result_;
  std::string on_derivatives_;  ///< the last that was let go of them
  BestSoFar shown_;
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/replay.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <span>
#include <string>

#include "core/rng.h"
#include "core/text.h"
#include "optimizer/front/front.h"

namespace glint {

namespace {

/// Asks that are computed again when the state follows from the record, beside the last batch.
constexpr int kNumDrawnAsks = 10;
/// Keeps their random numbers apart from the other users of the study's seed.
constexpr std::uint64_t kReplaySeeds = 1ULL << 36;

bool same_bits(const Point& a, const Point& b) {
  if (a.size() != b.size()) {
    return false;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) {
      return false;
    }
  }
  return true;
}

std::string point_text(const Point& point) {
  std::vector<std::string> values;
  for (const double value : point) {
    values.push_back(shortest(value));
  }
  return "(" + join(values, ", ") + ")";
}

[[noreturn]] void fail_changed(int trial, const std::string& recorded, const std::string& now) {
  throw ConfigError(
      "this study cannot be resumed: trial " + std::to_string(trial) + " was recorded as " +
      recorded + ", but now it would be " + now +
      "; the program, a library or the machine changed since. Run into a new folder; the old best "
      "design can be given as a start point");
}

[[noreturn]] void fail_damaged(const std::string& what) {
  throw IoError("the study database is damaged: " + what);
}

/// Computes the ask again and compares it; otherwise repeats what it did to the algorithm.
void replay_ask(const Event& event, bool is_computed, SearchMemory& memory) {
  if (event.trial < 1 || static_cast<std::size_t>(event.trial) > memory.trials.size()) {
    fail_damaged("it asks for trial " + std::to_string(event.trial) + ", which it does not hold");
  }
  const Point& recorded = memory.trial(event.trial).point;
  if (!is_computed) {
    memory.algorithm->restore_ask(recorded);
    memory.note_ask(event.trial);
    return;
  }
  const std::optional<Point> asked = memory.algorithm->ask();
  memory.algorithm->take_events();
  if (!asked || !same_bits(*asked, recorded)) {
    fail_changed(event.trial, point_text(recorded), asked ? point_text(*asked) : "the end");
  }
  memory.note_ask(event.trial);
}

void replay_tell(const Goal& goal, const Event& event, SearchMemory& memory) {
  if (memory.in_flight.empty() || memory.in_flight.front() != event.trial ||
      !memory.trial(event.trial).outcome) {
    fail_damaged("it tells trial " + std::to_string(event.trial) + " out of order");
  }
  const Event told = memory.tell_next(goal);
  if (!same_bits({told.value}, {event.value})) {
    fail_changed(event.trial, "merit " + shortest(event.value), "merit " + shortest(told.value));
  }
  if (!same_bits(told.objectives, event.objectives)) {
    fail_changed(event.trial,
                 "objectives " + point_text(event.objectives),
                 "objectives " + point_text(told.objectives));
  }
}

void replay_reference(const Goal& goal, const Event& event, SearchMemory& memory) {
  const std::optional<Event> fixed = memory.fix_reference(goal);
  if (!fixed || !same_bits(fixed->objectives, event.objectives)) {
    fail_changed(event.trial,
                 "reference " + point_text(event.objectives),
                 fixed ? "reference " + point_text(fixed->objectives) : "no reference");
  }
}

/// Which asks are computed again, counted from 0: all, or where the method can do without the last
/// batch and drawn ones.
std::set<std::size_t> asks_to_compute(const SearchTask& task,
                                      std::span<const Event> events,
                                      const Algorithm& algorithm) {
  const auto num_asks =
      static_cast<std::size_t>(std::ranges::count(events, EventKind::kAsk, &Event::kind));
  std::set<std::size_t> computed;
  if (task.verify_replay || !algorithm.can_restore()) {
    for (std::size_t i = 0; i < num_asks; ++i) {
      computed.insert(i);
    }
    return computed;
  }
  const std::size_t last = std::min(num_asks, static_cast<std::size_t>(task.settings.batch));
  for (std::size_t i = num_asks - last; i < num_asks; ++i) {
    computed.insert(i);
  }
  Rng rng(task.settings.seed, Stream::kSearch, kReplaySeeds + num_asks);
  for (int i = 0; i < kNumDrawnAsks && num_asks > 0; ++i) {
    computed.insert(static_cast<std::size_t>(rng.uniform() * static_cast<double>(num_asks)));
  }
  return computed;
}

/// The references that the goal gives, minimised; NaN where it gives none.
std::vector<double> given_reference(const Goal& goal) {
  std::vector<double> reference;
  for (const Objective& objective : objectives_of(goal)) {
    const double sign = objective.is_maximised ? -1.0 : 1.0;
    reference.push_back(objective.reference ? sign * *objective.reference + 0.0 : std::nan(""));
  }
  return reference;
}

/// The points of all trials that were asked before the last epoch began, by their numbers; none in
/// the first epoch.
std::vector<Point> archived_points(const Storage& storage) {
  const std::vector<Event> events = storage.events();
  int last = 0;
  for (const Event& event : std::span(events).first(events.size() - last_epoch(events).size())) {
    last = event.kind == EventKind::kAsk ? std::max(last, event.trial) : last;
  }
  std::vector<Point> points;
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    if (trial.number <= last) {
      points.push_back(trial.point);
    }
  }
  return points;
}

/// What the algorithm is asked to begin with: what was asked before, and start points that were
/// not, as an epoch may begin before all are asked. By rules 4 and before a start point that is
/// given twice is asked and told twice, and an epoch drops what was not asked.
std::vector<Point> first_points(const SearchTask& task, const std::vector<Point>& archived) {
  if (task.settings.rules < 5) {
    return archived.empty() ? task.start_points : archived;
  }
  std::vector<Point> points = archived;
  for (const Point& start : task.start_points) {
    const Point point = canonical(task.space, start);
    if (std::ranges::find(points, point) == points.end()) {
      points.push_back(point);
    }
  }
  return points;
}

/// How many trials an earlier run has given: they are the first ones, and each is one design.
int count_given(const SearchTask& task) {
  std::set<Point> points;
  for (const Point& start : task.start_points) {
    points.insert(canonical(task.space, start));
  }
  return task.is_start_known ? static_cast<int>(points.size()) : 0;
}

/// Of each objective: the largest noise of the difference of a design to one that surely gained.
std::vector<double> noise_of_lead(const Goal& goal, const Scores& scores, SearchMemory& memory) {
  std::vector<double> noise;
  for (const Objective& objective : objectives_of(goal)) {
    noise.push_back(0.0);
    for (const int number : memory.surely_gained) {
      const Scores& other = memory.trial(number).outcome->scores;
      noise.back() = std::max(noise.back(), difference_noise(objective, scores, other));
    }
  }
  return noise;
}

/// Whether what a design adds to the hypervolume of those that surely gained is larger than its
/// noise: by how much it changes, at most, where the design moves by noise_of_lead() in one
/// objective; squares summed over the objectives.
bool adds_more_than_noise(const Goal& goal, const Scores& scores, SearchMemory& memory) {
  const std::vector<double> noise = noise_of_lead(goal, scores, memory);
  if (std::ranges::none_of(noise, [](double size) { return size > 0.0; })) {
    return true;
  }
  std::vector<std::vector<double>> gained;
  for (const int number : memory.surely_gained) {
    gained.push_back(minimised_objectives(goal, memory.trial(number).outcome->scores));
  }
  std::vector<std::vector<double>> rows;
  for (const std::size_t row : front_of(gained)) {
    rows.push_back(gained[row]);
  }
  const double before = hypervolume(rows, memory.reference);
  rows.push_back(minimised_objectives(goal, scores));
  const auto gain = [&] { return hypervolume(rows, memory.reference) - before; };
  const double seen = gain();
  double squares = 0.0;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const double value = rows.back()[i];
    double change = 0.0;
    for (const double moved : {value - noise[i], value + noise[i]}) {
      rows.back()[i] = moved;
      change = std::max(change, std::abs(gain() - seen));
    }
    rows.back()[i] = value;
    squares += change * change;
  }
  return squares <= 0.0 || seen > std::sqrt(squares);
}

/// Whether a told outcome that did not fail counts as progress. See Budget::stall.
bool is_sure_gain(const Goal& goal, const Scores& scores, SearchMemory& memory) {
  const auto beats = [&](int number) {
    return is_surely_better(goal, scores, memory.trial(number).outcome->scores);
  };
  const bool is_first_feasible = memory.surely_gained.empty() && is_feasible(goal, scores);
  if (!has_several_objectives(goal) ||
      (!is_feasible(goal, scores) && memory.surely_gained.empty())) {
    return !memory.surely_best || beats(*memory.surely_best);
  }
  if (!is_feasible(goal, scores)) {
    return false;
  }
  const std::vector<double> values = minimised_objectives(goal, scores);
  for (std::size_t i = 0; i < memory.reference.size(); ++i) {
    if (!(values[i] < memory.reference[i])) {
      return is_first_feasible;
    }
  }
  return std::ranges::all_of(memory.surely_gained, beats) &&
         (memory.rules < 6 || memory.reference.empty() ||
          adds_more_than_noise(goal, scores, memory));
}

}  // namespace

void SearchMemory::note_ask(int number) {
  told_before_batch = tells.size();
  if (number > num_known) {
    num_known = number;
    num_idle = 0;
  } else {
    ++num_reused;
    ++num_idle;
  }
  in_flight.push_back(number);
}

std::optional<Event> SearchMemory::fix_reference(const Goal& goal) {
  if (!has_several_objectives(goal) || !reference.empty() || num_told < num_design) {
    return std::nullopt;
  }
  const std::span<const Trial> told(trials.data(), static_cast<std::size_t>(num_told));
  reference = reference_of(goal, told);
  if (reference.empty()) {
    return std::nullopt;
  }
  return Event{.kind = EventKind::kReference, .trial = num_told, .objectives = reference};
}

Event SearchMemory::tell_next(const Goal& goal) {
  const int number = in_flight.front();
  in_flight.pop_front();
  const Trial& told = trial(number);
  const Outcome& outcome = *told.outcome;
  const Answer answer = merit.next(told.point, outcome);
  algorithm->tell(told.point, answer);
  tells.push_back(number);
  Event event{.kind = EventKind::kTell, .trial = number, .value = answer.merit};
  if (has_several_objectives(goal) && !outcome.is_failed) {
    event.objectives = answer.objectives;
  }
  if (number <= num_told) {
    return event;
  }
  num_told = number;
  since_better = is_new(number) ? since_better + 1 : 0;
  if (outcome.is_failed) {
    ++num_failed;
    return event;
  }
  if (!best || is_better(goal, outcome.scores, trial(*best).outcome->scores)) {
    best = number;
  }
  if (is_sure_gain(goal, outcome.scores, *this)) {
    surely_best = number;
    since_better = 0;
    if (has_several_objectives(goal) && is_feasible(goal, outcome.scores)) {
      surely_gained.push_back(number);
    }
  }
  return event;
}

std::span<const Event> last_epoch(std::span<const Event> events) {
  std::size_t begin = events.size();
  while (begin > 0 && events[begin - 1].kind != EventKind::kEpoch) {
    --begin;
  }
  return events.subspan(begin);
}

SearchMemory make_memory(const SearchTask& task, const Storage& storage) {
  check(task.goal);
  const std::vector<Point> archived = archived_points(storage);
  std::unique_ptr<Algorithm> algorithm = make_algorithm(task.space,
                                                        task.settings,
                                                        first_points(task, archived),
                                                        num_limits(task.goal),
                                                        num_objectives(task.goal),
                                                        given_reference(task.goal),
                                                        ExactValues(task.goal, task.exact));
  const int num_design = design_size(task.space, task.settings);
  return {
      .rules = task.settings.rules,
      .algorithm = std::move(algorithm),
      .merit = MeritFunction(task.space,
                             task.goal,
                             failure_policy(task.space, task.settings, num_objectives(task.goal)),
                             num_design,
                             !task.settings.derivatives,
                             task.settings.rules > 5),
      .num_archived = static_cast<int>(archived.size()),
      .num_given = count_given(task),
      .num_design = num_design};
}

int recorded_rules(std::span<const Event> events, int latest) {
  bool has_asked = false;
  for (const Event& event : events) {
    if (event.kind == EventKind::kRules) {
      if (!(event.value >= 1.0 && event.value <= kSearchRules)) {
        throw ConfigError("this study was begun by a newer Glint (search rules " +
                          shortest(event.value) + ", this program knows " +
                          std::to_string(kSearchRules) + ")");
      }
      return static_cast<int>(event.value);
    }
    has_asked = has_asked || event.kind == EventKind::kAsk;
  }
  return has_asked ? 1 : latest;
}

void begin_log(const SearchTask& task, Storage& storage) {
  for (const Event& event : storage.events()) {
    if (event.kind == EventKind::kAsk || event.kind == EventKind::kRules) {
      return;
    }
  }
  const int rules = task.settings.rules;
  const std::string name = resolved_algorithm(task.space, task.settings, num_objectives(task.goal));
  storage.append(
      std::vector<Event>{{.kind = EventKind::kRules,
                          .value = static_cast<double>(rules),
                          .text = "search rules " + std::to_string(rules) + ", " + name}});
}

void replay(const SearchTask& task, const Storage& storage, SearchMemory& memory) {
  memory.trials = storage.trials(TrialKind::kSearch);
  for (std::size_t i = 0; i < memory.trials.size(); ++i) {
    const Trial& trial = memory.trials[i];
    if (trial.number != static_cast<int>(i) + 1 ||
        trial.point.size() != task.space.variables.size()) {
      fail_damaged("trial " + std::to_string(i + 1) + " is missing or has another shape");
    }
    memory.number_of[trial.point] = trial.number;
  }
  const std::vector<Event> log = storage.events();
  const std::span<const Event> events = last_epoch(log);
  const std::set<std::size_t> computed = asks_to_compute(task, events, *memory.algorithm);
  const bool is_restored = memory.algorithm->can_restore() && !task.verify_replay;
  std::size_t num_asks = 0;
  for (const Event& event : events) {
    switch (event.kind) {
      case EventKind::kAsk:
        replay_ask(event, computed.contains(num_asks++), memory);
        break;
      case EventKind::kModel:
        memory.note_model();
        if (is_restored) {
          memory.algorithm->restore_model(event.objectives);
        }
        break;
      case EventKind::kTell:
        replay_tell(task.goal, event, memory);
        break;
      case EventKind::kReference:
        replay_reference(task.goal, event, memory);
        break;
      case EventKind::kAbandon:
        memory.algorithm->abandon_run(static_cast<int>(event.value));
        break;
      case EventKind::kRestart:
      case EventKind::kNote:
      case EventKind::kRules:
      case EventKind::kEpoch:
      case EventKind::kReplicate:
        break;
    }
  }
}

}  // namespace glint

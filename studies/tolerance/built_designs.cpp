// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/tolerance/built_designs.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "core/jobs.h"
#include "core/wall_clock.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/algorithm/sobol.h"
#include "studies/imaging/searched/searched_scene.h"

namespace glint {
namespace {

/// Keeps these designs apart from those that a search of the same seed begins with.
constexpr std::uint64_t kSpreadSeeds = 1ULL << 41;

std::vector<Tolerance> tolerances_of(const Study& study) {
  std::vector<Problem> errors;
  std::vector<Tolerance> tolerances = read_tolerances(study, errors);
  throw_if_any(errors);
  return tolerances;
}

/// The point's values with one more, or another, for this key.
void move_key(const Study& study, const std::string& key, double offset, Overrides& overrides) {
  auto found = std::ranges::find(overrides, key, &Overrides::value_type::first);
  if (found == overrides.end()) {
    overrides.emplace_back(key, *study.resolved.at_path(key));
    found = std::prev(overrides.end());
  }
  found->second = moved_value(found->second, found->second.number + offset);
}

/// Opens the record; built designs that were rendered otherwise are withdrawn.
Storage open_record(const std::filesystem::path& run,
                    const StudyIdentity& identity,
                    const std::optional<SearchRungs>& rungs) {
  Storage storage = Storage::open(run / kBuiltTrials, identity);
  std::string recorded;
  for (const Event& event : storage.events()) {
    recorded = event.kind == EventKind::kEpoch ? event.text : recorded;
  }
  const std::string wanted = rungs ? rungs->name() : "";
  if (wanted != recorded) {
    storage.begin_epoch({.kind = EventKind::kEpoch, .text = wanted});
  }
  return storage;
}

Point joined(const Point& design, const std::vector<double>& added) {
  Point point = design;
  point.insert(point.end(), added.begin(), added.end());
  return point;
}

}  // namespace

BuiltDesigns::BuiltDesigns(SceneStore& store,
                           const Study& study,
                           const StudyIdentity& identity,
                           const std::filesystem::path& run,
                           std::optional<SearchRungs> rungs,
                           int jobs,
                           const std::atomic<int>* interrupt)
    : store_(store),
      study_(study),
      rungs_(std::move(rungs)),
      jobs_(jobs),
      interrupt_(interrupt),
      tolerances_(tolerances_of(study)),
      storage_(open_record(run, identity, rungs_)) {
  for (Trial& trial : storage_.trials(TrialKind::kSearch)) {
    known_[trial.point] = std::move(trial);
  }
}

std::vector<BuiltScores> BuiltDesigns::build(const std::vector<Point>& designs,
                                             int first,
                                             int count) {
  std::vector<Point> points;
  for (const Point& design : designs) {
    for (int k = first; k < first + count; ++k) {
      points.push_back(joined(design, added(k)));
    }
  }
  evaluate_all(points);
  std::vector<BuiltScores> built(designs.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!known_.at(points[i]).outcome) {
      return {};
    }
    built[i / static_cast<std::size_t>(count)].push_back(scores_of(points[i]));
  }
  return built;
}

std::vector<Point> BuiltDesigns::variable_offsets() const {
  const std::vector<Variable>& variables = study_.space.variables;
  std::vector<Point> offsets;
  for (int k = 0; k < kToleranceDesigns; ++k) {
    const std::vector<double> all = added(k);
    Point offset(variables.size(), 0.0);
    for (std::size_t i = 0; i < tolerances_.size(); ++i) {
      const auto found = std::ranges::find(variables, tolerances_[i].key, &Variable::name);
      if (found != variables.end()) {
        offset[static_cast<std::size_t>(found - variables.begin())] = all[i];
      }
    }
    offsets.push_back(std::move(offset));
  }
  return offsets;
}

std::vector<double> BuiltDesigns::added(int built) const {
  if (built == kExact) {
    std::vector<double> zeros(tolerances_.size(), 0.0);
    return zeros;
  }
  const Sobol sequence(study_.search.seed + kSpreadSeeds, static_cast<int>(tolerances_.size()));
  std::vector<double> offsets = sequence.point(static_cast<std::uint32_t>(built));
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double plus_minus = tolerances_[i].plus_minus;
    offsets[i] =
        tolerances_[i].is_integer
            ? std::min(plus_minus, std::floor(offsets[i] * (2.0 * plus_minus + 1.0)) - plus_minus)
            : (2.0 * offsets[i] - 1.0) * plus_minus;
  }
  return offsets;
}

void BuiltDesigns::ask(const std::vector<Point>& points) {
  std::vector<Event> events;
  std::vector<Trial> trials;
  for (const Point& point : points) {
    if (!known_.contains(point)) {
      const int number = static_cast<int>(known_.size()) + 1;
      events.push_back({.kind = EventKind::kAsk, .trial = number});
      trials.push_back({.number = number, .point = point});
      known_[point] = trials.back();
    }
  }
  storage_.append(events, trials);
}

/// Some at once, each on a thread of its own, as a search does. Tolerances of integers give the
/// same point more than once.
void BuiltDesigns::evaluate_all(const std::vector<Point>& points) {
  ask(points);
  std::vector<Trial*> missing;
  for (const Point& point : points) {
    Trial& trial = known_.at(point);
    if (!trial.outcome && std::ranges::find(missing, &trial) == missing.end()) {
      missing.push_back(&trial);
    }
  }
  run_jobs(
      missing.size(),
      jobs_,
      [&](std::size_t i) {
        missing[i]->outcome = outcome_of(missing[i]->point);
        storage_.record(TrialKind::kSearch, missing[i]->number, *missing[i]->outcome);
      },
      [&] { return interrupt_ != nullptr && *interrupt_ > 0; });
}

/// A design that cannot be made is data.
Outcome BuiltDesigns::outcome_of(const Point& point) const {
  const auto start = std::chrono::steady_clock::now();
  const auto num_variables = static_cast<std::ptrdiff_t>(study_.space.variables.size());
  Outcome outcome;
  try {
    Overrides overrides = overrides_of(study_, Point(point.begin(), point.begin() + num_variables));
    for (std::size_t i = 0; i < tolerances_.size(); ++i) {
      const double offset = point[static_cast<std::size_t>(num_variables) + i];
      if (offset != 0.0) {
        move_key(study_, tolerances_[i].key, offset, overrides);
      }
    }
    const SceneSettings own = scene_with(study_, overrides);
    const WantedScores wanted = wanted_by(study_.goal);
    const RenderRung* rung = rungs_ ? &rungs_->of(point) : nullptr;
    const SceneSettings scene =
        rung != nullptr ? searched_scene(store_, own, *rung, wanted.trials) : own;
    outcome.scores = evaluate(store_, scene, {}, wanted).scores;
    if (rung != nullptr) {
      less_offsets(own, scene, *rung, outcome.scores);
    }
  } catch (const IoError&) {
    throw;  // says nothing about the design
  } catch (const Error& error) {
    outcome = {.is_failed = true, .message = error.what()};
  }
  std::erase_if(outcome.scores, [](const auto& score) { return std::isnan(score.second); });
  for (auto& [name, value] : outcome.scores) {
    value += 0.0;  // the database keeps no negative zeros
  }
  outcome.seconds = seconds_since(start);
  return outcome;
}

std::optional<Scores> BuiltDesigns::scores_of(const Point& point) const {
  const std::optional<Outcome>& outcome = known_.at(point).outcome;
  const bool is_judged =
      outcome && !outcome->is_failed && problem_with(study_.goal, outcome->scores).empty();
  return is_judged ? std::optional(outcome->scores) : std::nullopt;
}

}  // namespace glint

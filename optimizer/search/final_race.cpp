// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/final_race.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <span>
#include <utility>

#include "core/rng.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/search/expected_limits.h"
#include "optimizer/search/search.h"

namespace glint {
namespace {

constexpr int kRoundReplicates = 2;
constexpr int kSamples = 4000;
/// Of being better than the best so far; below it a design is given up.
constexpr double kHopelessLead = 0.01;
constexpr std::uint64_t kRaceDraws = 1ULL << 20;

/// Which replicates are drawn, and sqrt(n / chi-square(n - 1)), which makes Student's distribution
/// of a bootstrap of few.
struct RaceDraw {
  std::vector<std::size_t> replicates;
  double width = 1.0;
};

RaceDraw draw_replicates(std::size_t count, int sample) {
  Rng rng(1, Stream::kResampling, kRaceDraws + static_cast<std::uint64_t>(sample));
  RaceDraw draw;
  for (std::size_t k = 0; k < count; ++k) {
    const auto drawn = static_cast<std::size_t>(rng.uniform() * static_cast<double>(count));
    draw.replicates.push_back(std::min(count - 1, drawn));
  }
  double squares = 0.0;
  for (std::size_t k = 1; k < count; ++k) {
    const double normal = rng.normal();
    squares += normal * normal;
  }
  draw.width = std::sqrt(static_cast<double>(count) / std::max(squares, 1e-12));
  return draw;
}

std::vector<std::string> judged_scores(const Goal& goal) {
  std::vector<std::string> names;
  for (const Objective& objective : objectives_of(goal)) {
    names.push_back(objective.name);
  }
  for (const Constraint& constraint : goal.constraints) {
    names.push_back(constraint.name);
  }
  return names;
}

/// Of the designs that have raced, by their keys: the search's trial, 0 of none.
std::map<std::string, int> raced_trials(const Storage& storage) {
  std::map<std::string, int> trials;
  for (const Event& event : storage.events()) {
    if (event.kind == EventKind::kReplicate) {
      trials[event.text] = event.trial;
    }
  }
  return trials;
}

class FinalRacing {
 public:
  FinalRacing(const Goal& goal,
              const std::vector<Entrant>& entrants,
              Storage& storage,
              const EvaluateReplicate& evaluate,
              RaceLimits limits,
              const LabelOfReplicate& label)
      : goal_(goal),
        entrants_(entrants),
        storage_(storage),
        evaluate_(evaluate),
        limits_(limits),
        label_(label),
        names_(judged_scores(goal)) {
    found_.racers.resize(entrants.size());
    const std::map<std::string, int> trials = raced_trials(storage);
    std::map<std::string, int> counts;
    std::vector<Replicate> replicates;
    for (const Trial& known : storage.trials(TrialKind::kReplicate)) {
      const int replicate = counts[known.name]++;
      known_[{known.name, replicate}] = known;
      next_ = known.number + 1;
      const auto trial = trials.find(known.name);
      std::ranges::move(
          labelled_outcome(known, trial != trials.end() ? trial->second : 0, replicate),
          std::back_inserter(replicates));
    }
    storage.record_missing(replicates);  // programs before recorded none
  }

  /// @return false: interrupted
  bool run(const std::atomic<int>* interrupt) {
    for (int done = 0; done < kAllReplicates;) {
      const int wanted = done == 0 ? kFirstReplicates : done + kRoundReplicates;
      for (std::size_t i = 0; i < entrants_.size(); ++i) {
        for (int k = done; k < wanted && !found_.racers[i].is_given_up; ++k) {
          if (interrupt != nullptr && interrupt->load() > 0) {
            return false;
          }
          add_replicate(i, k);
        }
      }
      done = wanted;
      judge_limits();
      give_up();
    }
    return true;
  }

  FinalRace result() {
    for (Racer& racer : found_.racers) {
      racer.keeps_limits =
          !racer.replicates.empty() &&
          (racer.feasible_chance ? is_likely(racer)
                                 : is_feasible(goal_, mean_scores(racer.replicates)));
    }
    found_.best = best_of(true);
    share_probability();
    return std::move(found_);
  }

 private:
  void add_replicate(std::size_t index, int replicate) {
    const Entrant& entrant = entrants_[index];
    Racer& racer = found_.racers[index];
    const Outcome outcome = outcome_of(entrant, replicate);
    ++found_.evaluations;
    if (outcome.is_failed) {
      racer.is_given_up = true;
    } else {
      racer.replicates.push_back(outcome.scores);
    }
  }

  /// What is recorded of it; one that failed in an earlier run is tried again and takes its place.
  Outcome outcome_of(const Entrant& entrant, int replicate) {
    const auto known = known_.find({entrant.key, replicate});
    if (known == known_.end()) {
      Outcome outcome = evaluated(entrant, replicate);
      append(entrant, replicate, outcome);
      return outcome;
    }
    Trial& trial = known->second;
    if (trial.outcome->is_failed) {
      trial.outcome = evaluated(entrant, replicate);
      storage_.record(TrialKind::kReplicate,
                      trial.number,
                      *trial.outcome,
                      labelled_outcome(trial, entrant.trial, replicate));
    }
    return *trial.outcome;
  }

  Outcome evaluated(const Entrant& entrant, int replicate) const {
    Outcome outcome;
    try {
      outcome.scores = evaluate_(entrant, replicate);
      outcome.message = problem_with(goal_, outcome.scores);
      outcome.is_failed = !outcome.message.empty();
    } catch (const EvaluationAborted&) {
      throw;
    } catch (const IoError&) {
      throw;
    } catch (const Error& error) {
      outcome = {.is_failed = true, .message = error.what()};
    }
    return outcome;
  }

  void append(const Entrant& entrant, int replicate, const Outcome& outcome) {
    const Event event = {.kind = EventKind::kReplicate,
                         .trial = entrant.trial,
                         .value = static_cast<double>(replicate),
                         .text = entrant.key};
    const Trial trial = {.kind = TrialKind::kReplicate,
                         .number = next_++,
                         .name = entrant.key,
                         .point = entrant.point,
                         .outcome = outcome};
    storage_.append({&event, 1}, {&trial, 1}, labelled_outcome(trial, entrant.trial, replicate));
  }

  /// A replicate of the search's trial or, of a design that is none, of the race's own.
  /// @param raced   of the race, with an outcome
  /// @param number  of the search's trial; 0: of none
  std::vector<Replicate> labelled_outcome(const Trial& raced, int number, int replicate) const {
    std::vector<Replicate> replicates;
    if (label_) {
      const Entrant entrant = {.key = raced.name, .trial = number, .point = raced.point};
      const bool is_of_search = number > 0;
      replicates.push_back(labelled(label_(entrant, replicate),
                                    is_of_search ? TrialKind::kSearch : TrialKind::kReplicate,
                                    is_of_search ? number : raced.number,
                                    *raced.outcome));
    }
    return replicates;
  }

  Scores mean_scores(const std::vector<Scores>& replicates) const {
    Scores mean;
    for (const std::string& name : names_) {
      for (const Scores& one : replicates) {
        mean[name] += one.at(name) / static_cast<double>(replicates.size());
      }
    }
    return mean;
  }

  Scores drawn_scores(const Racer& racer, const RaceDraw& draw) const {
    Scores scores = mean_scores(racer.replicates);
    for (auto& [name, value] : scores) {
      double drawn = 0.0;
      for (const std::size_t k : draw.replicates) {
        drawn += racer.replicates[k].at(name) / static_cast<double>(draw.replicates.size());
      }
      if (std::isfinite(value)) {  // an infinite mean stays so: NaN would keep every limit
        value += draw.width * (drawn - value);
      }
    }
    return scores;
  }

  void judge_limits() {
    if (limits_ == RaceLimits::kByMeans || goal_.constraints.empty()) {
      return;
    }
    for (Racer& racer : found_.racers) {
      if (!racer.replicates.empty()) {
        racer.feasible_chance = share_feasible(racer);
      }
    }
  }

  double share_feasible(const Racer& racer) const {
    int count = 0;
    for (int sample = 0; sample < kSamples; ++sample) {
      const RaceDraw draw = draw_replicates(racer.replicates.size(), sample);
      count += is_feasible(goal_, drawn_scores(racer, draw)) ? 1 : 0;
    }
    return static_cast<double>(count) / kSamples;
  }

  static bool is_likely(const Racer& racer) {
    return racer.feasible_chance.value_or(1.0) >= kFeasibleChance;
  }

  /// By their means; both have replicates.
  bool leads(const Racer& a, const Racer& b) const {
    if (is_likely(a) != is_likely(b)) {
      return is_likely(a);
    }
    return is_better(goal_, mean_scores(a.replicates), mean_scores(b.replicates));
  }

  /// By the means, of those that are still in the race; of equals the first.
  /// @param is_of_search  trials alone; where all are given up the best of them
  std::size_t best_of(bool is_of_search) const {
    std::optional<std::size_t> best;
    for (const bool may_be_given_up : {false, true}) {
      for (std::size_t i = 0; i < entrants_.size() && (may_be_given_up ? !best : true); ++i) {
        const Racer& racer = found_.racers[i];
        const bool counts = !racer.replicates.empty() && (may_be_given_up || !racer.is_given_up) &&
                            (!is_of_search || entrants_[i].trial > 0);
        if (counts && (!best || leads(racer, found_.racers[*best]))) {
          best = i;
        }
      }
    }
    return best.value_or(0);
  }

  double share_better(std::size_t a, std::size_t b) const {
    const std::size_t count = found_.racers[a].replicates.size();
    double share = 0.0;
    for (int sample = 0; sample < kSamples; ++sample) {
      const RaceDraw draw = draw_replicates(count, sample);
      const bool leads = is_better(
          goal_, drawn_scores(found_.racers[a], draw), drawn_scores(found_.racers[b], draw));
      share += leads ? 1.0 / kSamples : 0.0;
    }
    return share;
  }

  /// The best trial stays: it is the winner, whatever it is compared with.
  void give_up() {
    const std::size_t winner = best_of(true);
    const std::size_t leader = best_of(false);
    std::vector<std::size_t> hopeless;
    for (std::size_t i = 0; i < entrants_.size(); ++i) {
      const std::size_t rival = entrants_[i].trial > 0 ? winner : leader;
      if (!found_.racers[i].is_given_up && i != winner && i != leader &&
          share_better(i, rival) < kHopelessLead) {
        hopeless.push_back(i);
      }
    }
    for (const std::size_t i : hopeless) {
      found_.racers[i].is_given_up = true;
    }
  }

  void share_probability() {
    std::vector<Racer*> racing;
    for (Racer& racer : found_.racers) {
      if (!racer.is_given_up) {
        racing.push_back(&racer);
      }
    }
    std::map<const Racer*, int> wins;
    for (int sample = 0; sample < kSamples && !racing.empty(); ++sample) {
      const RaceDraw draw = draw_replicates(racing.front()->replicates.size(), sample);
      Racer* best = racing.front();
      Scores of_best = drawn_scores(*best, draw);
      for (Racer* racer : std::span(racing).subspan(1)) {
        Scores scores = drawn_scores(*racer, draw);
        if (is_better(goal_, scores, of_best)) {
          best = racer;
          of_best = std::move(scores);
        }
      }
      ++wins[best];
    }
    for (Racer* racer : racing) {
      racer->probability = static_cast<double>(wins[racer]) / kSamples;
    }
  }

  const Goal& goal_;
  const std::vector<Entrant>& entrants_;
  Storage& storage_;
  const EvaluateReplicate& evaluate_;
  RaceLimits limits_;
  const LabelOfReplicate& label_;
  std::vector<std::string> names_;
  std::map<std::pair<std::string, int>, Trial> known_;
  int next_ = 1;  ///< number of the next replicate in the database
  FinalRace found_;
};

}  // namespace

int race_size(int evaluations) {
  constexpr int kEvaluationsPerFinalist = 12;
  return std::clamp(evaluations / kEvaluationsPerFinalist, 2, 8);
}

std::optional<FinalRace> run_final_race(const Goal& goal,
                                        const std::vector<Entrant>& entrants,
                                        Storage& storage,
                                        const EvaluateReplicate& evaluate,
                                        const std::atomic<int>* interrupt,
                                        RaceLimits limits,
                                        const LabelOfReplicate& label) {
  FinalRacing race(goal, entrants, storage, evaluate, limits, label);
  return race.run(interrupt) ? std::optional(race.result()) : std::nullopt;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/trade_off.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/text.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/front/front.h"
#include "optimizer/search/replay.h"

namespace glint {
namespace {

using Row = std::vector<double>;

constexpr double kDeviationsPerHalf = 2.0;  // as objective_noise() has it of standard errors

double sign_of(const Objective& objective) {
  return objective.is_maximised ? -1.0 : 1.0;
}

bool has_scores(const Trial& trial) {
  return trial.outcome && !trial.outcome->is_failed;
}

bool is_on_offer(const Goal& goal, const Trial& trial, const LimitExpectations& limits) {
  return has_scores(trial) && is_likely_feasible(goal, trial, limits);
}

bool is_inside(const Row& row, const Row& reference) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (!(row[i] < reference[i])) {
      return false;
    }
  }
  return true;
}

/// A design as a front judges it: by what is expected where anything is, else by what was seen.
struct Judged {
  int trial = 0;
  Row values;  ///< minimised objectives
  Row halves;  ///< half the interval of each
};

std::optional<Judged> judged(const Goal& goal,
                             const Trial& trial,
                             const Expectations& expected,
                             const LimitExpectations& limits) {
  const auto known = expected.find(trial.number);
  if (!is_on_offer(goal, trial, limits) || (!expected.empty() && known == expected.end())) {
    return std::nullopt;
  }
  const Scores& scores = trial.outcome->scores;
  Judged row{.trial = trial.number, .values = minimised_objectives(goal, scores), .halves = {}};
  const std::vector<Objective> objectives = objectives_of(goal);
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    if (expected.empty()) {
      row.halves.push_back(objective_noise(objectives[i], scores));
    } else {
      row.values[i] = sign_of(objectives[i]) * known->second[i].mean;
      row.halves.push_back(kDeviationsPerHalf * known->second[i].sd);
    }
  }
  return row;
}

/// Derivatives by differences of the width of each score's own interval.
/// @param halves  of each design of the front, Judged::halves
double hypervolume_noise(const std::vector<Row>& halves, const TradeOff& found) {
  double sum = 0.0;
  std::vector<Row> moved = found.front;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    for (std::size_t i = 0; i < moved[k].size(); ++i) {
      const double noise = halves[k][i];
      if (noise > 0.0) {
        moved[k][i] = found.front[k][i] + noise;
        const double change = hypervolume(moved, found.reference) - found.hypervolume;
        sum += change * change;
        moved[k][i] = found.front[k][i];
      }
    }
  }
  return std::sqrt(sum);
}

std::string reason_of(const Goal& goal, const TradeOff& found) {
  const std::size_t count = found.front.size();
  const std::string unbeaten = found.is_expected ? "that no other is expected to beat in everything"
                                                 : "that no other beats in everything";
  if (count == 1) {
    return "the only design " + unbeaten;
  }
  const std::string of = " of the " + std::to_string(count) + " designs " + unbeaten;
  if (goal.choice == ChoiceRule::kWeights) {
    return "gives up least by the weights" + of;
  }
  if (goal.choice == ChoiceRule::kKnee) {
    return "nearest to the best of all objectives at once" + of;
  }
  std::vector<std::string> missed;
  const std::vector<Objective> objectives = objectives_of(goal);
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    const Objective& objective = objectives[i];
    if (objective.aspiration &&
        found.front[found.chosen][i] > sign_of(objective) * *objective.aspiration) {
      missed.push_back(objective.name);
    }
  }
  return missed.empty() ? "reaches every aspiration, and is the knee" + of
                        : "misses the aspirations least (" + join(missed, ", ") + ")" + of;
}

}  // namespace

std::vector<double> in_score_units(const Goal& goal, std::vector<double> objectives) {
  const std::vector<Objective> all = objectives_of(goal);
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    objectives[i] = sign_of(all[i]) * objectives[i] + 0.0;
  }
  return objectives;
}

FrontChoice front_choice_of(const Goal& goal) {
  FrontChoice choice{.rule = goal.choice};
  for (const Objective& objective : objectives_of(goal)) {
    choice.weights.push_back(objective.weight);
    choice.aspirations.push_back(objective.aspiration
                                     ? std::optional(sign_of(objective) * *objective.aspiration)
                                     : std::nullopt);
  }
  return choice;
}

std::vector<double> reference_of(const Goal& goal, std::span<const Trial> design) {
  Row reference;
  const std::vector<Objective> objectives = objectives_of(goal);
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    std::optional<double> worst;
    if (objectives[i].reference) {
      worst = sign_of(objectives[i]) * *objectives[i].reference + 0.0;
    }
    for (const Trial& trial : design) {
      if (!objectives[i].reference && has_scores(trial)) {
        const double value = minimised_objectives(goal, trial.outcome->scores)[i];
        worst = std::max(worst.value_or(value), value);
      }
    }
    if (!worst) {
      return {};
    }
    reference.push_back(*worst);
  }
  return reference;
}

TradeOff trade_off(const Goal& goal,
                   std::span<const Trial> trials,
                   const std::vector<double>& reference,
                   const Expectations& expected,
                   const LimitExpectations& limits) {
  TradeOff found{.reference = reference.empty() ? reference_of(goal, trials) : reference,
                 .is_expected = !expected.empty()};
  std::vector<Judged> offered;
  std::vector<Row> rows;
  for (const Trial& trial : trials) {
    if (const std::optional<Judged> one = judged(goal, trial, expected, limits)) {
      rows.push_back(one->values);
      offered.push_back(*one);
    }
  }
  std::vector<Row> halves;
  for (const std::size_t row : front_of(rows)) {
    halves.push_back(offered[row].halves);
    found.trials.push_back(offered[row].trial);
    found.front.push_back(rows[row]);
    found.outside += is_inside(rows[row], found.reference) ? 0 : 1;
  }
  if (!found.front.empty()) {
    found.hypervolume = hypervolume(found.front, found.reference);
    found.noise = hypervolume_noise(halves, found);
    found.chosen = compromise_of(found.front, front_choice_of(goal));
    found.reason = reason_of(goal, found);
  }
  return found;
}

std::optional<int> expected_best(const Goal& goal,
                                 std::span<const Trial> trials,
                                 std::span<const int> told,
                                 std::span<const std::vector<Expectation>> expected,
                                 const LimitExpectations& limits) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < std::min(told.size(), expected.size()); ++i) {
    const Trial& trial = trials[static_cast<std::size_t>(told[i] - 1)];
    if (!expected[i].empty() && is_on_offer(goal, trial, limits) &&
        (!best || expected[i][0].mean < expected[*best][0].mean)) {
      best = i;
    }
  }
  return best ? std::optional(told[*best]) : std::nullopt;
}

std::vector<double> hypervolume_history(const Goal& goal,
                                        std::span<const Trial> trials,
                                        const std::vector<double>& reference,
                                        const Expectations& expected,
                                        const LimitExpectations& limits) {
  std::vector<Row> front;
  std::vector<double> history;
  double volume = 0.0;
  for (const Trial& trial : trials) {
    if (!trial.outcome) {
      continue;
    }
    if (const std::optional<Judged> one = judged(goal, trial, expected, limits)) {
      front.push_back(one->values);
      std::vector<Row> kept;
      const std::vector<std::size_t> indices = front_of(front);
      const bool is_gain = !indices.empty() && indices.back() + 1 == front.size();
      for (const std::size_t row : indices) {
        kept.push_back(front[row]);
      }
      front = std::move(kept);
      volume = is_gain ? hypervolume(front, reference) : volume;
    }
    history.push_back(volume);
  }
  return history;
}

std::vector<double> recorded_reference(std::span<const Event> events) {
  const std::span<const Event> epoch = last_epoch(events);
  const auto found = std::ranges::find(epoch, EventKind::kReference, &Event::kind);
  return found == epoch.end() ? std::vector<double>{} : found->objectives;
}

}  // namespace glint

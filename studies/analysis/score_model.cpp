// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/score_model.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include "optimizer/algorithm/merit.h"
#include "optimizer/analysis/surrogate_indices.h"
#include "optimizer/search/trade_off.h"
#include "optimizer/surrogate/gaussian_process.h"
#include "studies/analysis/branches.h"
#include "studies/analysis/responses.h"

namespace glint {
namespace {

/// More make a fit slow and tell little more.
constexpr std::size_t kMaxPoints = 400;

struct Data {
  std::vector<Point> points;
  std::vector<double> values;
  std::vector<double> errors;  ///< NaN where not known
  std::size_t num_trials = 0;  ///< that tell the score
};

double finite_score(const Scores& scores, const std::string& name) {
  const auto found = scores.find(name);
  return found != scores.end() && std::isfinite(found->second)
             ? found->second
             : std::numeric_limits<double>::quiet_NaN();
}

/// Of a design that was evaluated again: the mean, and its standard error. @param count  with it
void add_again(Data& data, std::size_t at, double count, double value, double error) {
  data.values[at] += (value - data.values[at]) / count;
  data.errors[at] = std::hypot((count - 1.0) * data.errors[at], error) / count;
}

/// A design counts once, or it would be predicted without itself by what it is told again.
Data data_of(const SearchSpace& space, std::span<const Trial> trials, const std::string& score) {
  Data data;
  std::map<Point, std::size_t> place_of;
  std::vector<double> counts;
  for (const Trial& trial : trials) {
    if (!trial.outcome || trial.outcome->is_failed) {
      continue;
    }
    const double value = finite_score(trial.outcome->scores, score);
    if (std::isnan(value)) {
      continue;
    }
    ++data.num_trials;
    const double error = finite_score(trial.outcome->scores, score + ".error");
    const Point point = canonical(space, trial.point);
    const auto [place, is_new] = place_of.try_emplace(point, data.points.size());
    if (!is_new) {
      add_again(data, place->second, ++counts[place->second], value, error);
      continue;
    }
    data.points.push_back(point);
    data.values.push_back(value);
    data.errors.push_back(error);
    counts.push_back(1.0);
  }
  return data;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return sum;
}

/// Those that lie farthest from one another, beginning with the first.
Data spread_out(const SearchSpace& space, const Data& data) {
  if (data.points.size() <= kMaxPoints) {
    return data;
  }
  std::vector<std::vector<double>> units;
  for (const Point& point : data.points) {
    units.push_back(unit_from_point(space, point));
  }
  std::vector<double> gaps(units.size(), std::numeric_limits<double>::infinity());
  Data kept;
  std::size_t next = 0;
  while (kept.points.size() < kMaxPoints) {
    kept.points.push_back(data.points[next]);
    kept.values.push_back(data.values[next]);
    kept.errors.push_back(data.errors[next]);
    for (std::size_t k = 0; k < units.size(); ++k) {
      gaps[k] = std::min(gaps[k], distance(units[k], units[next]));
    }
    gaps[next] = -1.0;  // not again
    next = static_cast<std::size_t>(std::ranges::max_element(gaps) - gaps.begin());
  }
  return kept;
}

/// 1 - squared errors without itself / squared deviations, over these designs; none where all
/// values are the same.
std::optional<double> q2_of(const std::vector<Posterior>& without_itself,
                            const std::vector<double>& values,
                            const std::vector<std::size_t>& members) {
  double mean = 0.0;
  for (const std::size_t k : members) {
    mean += values[k] / static_cast<double>(members.size());
  }
  double errors = 0.0;
  double deviations = 0.0;
  for (const std::size_t k : members) {
    errors += std::pow(values[k] - without_itself[k].mean, 2);
    deviations += std::pow(values[k] - mean, 2);
  }
  const bool has_one_value = members.size() > 1 && std::ranges::all_of(members, [&](std::size_t k) {
                               return values[k] == values[members.front()];
                             });
  return has_one_value ? std::nullopt
                       : std::optional(deviations > 0.0 ? 1.0 - errors / deviations : 0.0);
}

/// The best feasible design of a branch by the run's goal; of several objectives the compromise.
std::optional<Point> best_point(const SearchSpace& space,
                                const Goal& goal,
                                std::span<const Trial> trials,
                                const std::string& branch) {
  std::vector<Trial> candidates;
  std::optional<std::size_t> best;
  std::vector<Point> points;
  std::ranges::transform(trials, std::back_inserter(points), [&](const Trial& trial) {
    return canonical(space, trial.point);
  });
  const std::vector<std::string> names = branch_names(space, points);
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const Trial& trial = trials[k];
    if (!trial.outcome || trial.outcome->is_failed ||
        !problem_with(goal, trial.outcome->scores).empty() ||
        !is_feasible(goal, trial.outcome->scores) || names[k] != branch) {
      continue;
    }
    candidates.push_back(trial);
    candidates.back().number = static_cast<int>(candidates.size());
    if (!best || is_better(goal, trial.outcome->scores, candidates[*best].outcome->scores)) {
      best = candidates.size() - 1;
    }
  }
  if (best && has_several_objectives(goal)) {
    const TradeOff found = trade_off(goal, candidates, {});
    best = static_cast<std::size_t>(found.trials[found.chosen] - 1);
  }
  return best ? std::optional(canonical(space, candidates[*best].point)) : std::nullopt;
}

std::vector<Importance> importance_of(const GaussianProcess& model,
                                      const SearchSpace& space,
                                      const Branch& branch) {
  const auto indices = surrogate_indices(
      model,
      [&](std::span<const double> unit) { return branch.point_at(space, unit); },
      static_cast<int>(branch.free.size()));
  std::vector<Importance> importance;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    importance.push_back({.variable = branch.free[k], .index = indices[k]});
  }
  return importance;
}

/// What the model is asked with.
struct Question {
  const SearchSpace& space;
  const Goal& goal;
  std::span<const Trial> trials;
  const Data& data;
  std::vector<std::string> branches;  ///< of each of the data's points
  const GaussianProcess& model;
  std::vector<Posterior> without_itself;
};

BranchAnalysis analyse_branch(const Question& question, const Branch& branch) {
  std::vector<std::size_t> members;
  std::vector<std::vector<double>> units;
  for (std::size_t k = 0; k < question.data.points.size(); ++k) {
    if (question.branches[k] == branch.name) {
      members.push_back(k);
      units.push_back(branch.unit_of(question.space, question.data.points[k]));
    }
  }
  const std::optional<double> q2 = q2_of(question.without_itself, question.data.values, members);
  const auto dimension = static_cast<int>(branch.free.size());
  BranchAnalysis analysis = {
      .name = branch.name, .evidence = evidence_of(q2, units, dimension), .map = {}};
  if (!analysis.evidence.is_enough() || dimension == 0) {
    return analysis;
  }
  analysis.importance = importance_of(question.model, question.space, branch);
  const ResponseModel responses(
      question.model,
      question.space,
      branch,
      best_point(question.space, question.goal, question.trials, branch.name));
  for (std::size_t k = 0; k < branch.free.size(); ++k) {
    analysis.responses.push_back(responses.over(k));
  }
  if (dimension > 1) {
    analysis.map = responses.over_pair(analysis.importance);
  }
  return analysis;
}

/// The whole space with all that varies as one box; decisive values are coordinates of it.
std::vector<Importance> importance_of_choices(const GaussianProcess& model,
                                              const SearchSpace& space) {
  Branch all = {.name = "",
                .unit = std::vector<double>(space.variables.size(), 0.5),
                .free = {},
                .values = {}};
  for (std::size_t i = 0; i < space.variables.size(); ++i) {
    if (num_values(space.variables[i]) > 1.0) {
      all.free.push_back(i);
      all.values.emplace_back();
    }
  }
  std::vector<Importance> importance = importance_of(model, space, all);
  const std::vector<std::size_t> deciding = deciding_variables(space);
  std::erase_if(importance, [&](const Importance& one) {
    return std::ranges::count(deciding, one.variable) == 0;
  });
  return importance;
}

}  // namespace

ScoreAnalysis analyse_score(const SearchSpace& space,
                            const Goal& goal,
                            std::span<const Trial> trials,
                            const std::string& score) {
  const Data all = data_of(space, trials, score);
  const Data data = spread_out(space, all);
  ScoreAnalysis analysis = {.score = score,
                            .points = static_cast<int>(data.points.size()),
                            .left_out = static_cast<int>(all.points.size() - data.points.size()),
                            .without = static_cast<int>(trials.size() - all.num_trials)};
  GaussianProcess model(space);
  Question question = {.space = space,
                       .goal = goal,
                       .trials = trials,
                       .data = data,
                       .branches = branch_names(space, data.points),
                       .model = model,
                       .without_itself = {}};
  if (!data.points.empty()) {
    model.fit(data.points, data.values, data.errors);
    analysis.q2 = model.leave_one_out_q2();
    analysis.noise = model.noise();
    question.without_itself = model.leave_one_out();
  }
  const std::vector<Branch> branches = branches_of(space, data.points);
  int wanted = 0;
  for (const Branch& branch : branches) {
    analysis.branches.push_back(analyse_branch(question, branch));
    wanted = std::max(wanted, analysis.branches.back().evidence.wanted);
  }
  analysis.wanted = wanted * static_cast<int>(branches.size());
  const bool are_covered = std::ranges::all_of(
      analysis.branches, [](const BranchAnalysis& one) { return one.evidence.is_covered; });
  if (branches.size() > 1 && are_covered && analysis.q2 >= kNeededQ2) {
    analysis.choices = importance_of_choices(model, space);
  }
  return analysis;
}

}  // namespace glint

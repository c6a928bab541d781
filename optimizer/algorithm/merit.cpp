// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/merit.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "core/config/keys.h"
#include "core/error.h"
#include "core/text.h"
#include "optimizer/front/front.h"

namespace glint {

namespace {

constexpr double kMaxViolation = 1e6;
constexpr double kMaxMerit = 1e100;
constexpr double kErrorsPerHalf = 2.0;  // an interval of 95 %, as others are

double minimised(const Objective& objective, const Scores& scores) {
  const double value = scores.at(objective.name);
  return (objective.is_maximised ? -value : value) + 0.0;
}

/// What a violation is a part of.
double unit_of(double limit) {
  return limit == 0.0 ? 1.0 : std::abs(limit);
}

/// How far `excess` beyond a limit is, as a part of the limit.
double relative(double excess, double limit) {
  return std::min(excess / unit_of(limit), kMaxViolation);
}

/// One border of a constraint; its sign times the score must stay below sign times the border.
struct Limit {
  double border = 0.0;
  double sign = 1.0;
  double margin = 0.0;
};

std::vector<Limit> limits_of(const Constraint& constraint) {
  std::vector<Limit> limits;
  if (constraint.min) {
    limits.push_back({*constraint.min, -1.0, MeritFunction::kLimitMargin});
  }
  if (constraint.max) {
    limits.push_back({*constraint.max, 1.0, MeritFunction::kLimitMargin});
  }
  if (constraint.min && constraint.max) {
    // Room must remain between the two.
    for (Limit& limit : limits) {
      const double room = (*constraint.max - *constraint.min) / unit_of(limit.border);
      limit.margin = std::min(limit.margin, 0.25 * room);
    }
  }
  return limits;
}

/// factor * d(score) / d(unit coordinate); empty when not known by all that can be varied.
std::vector<double> gradient_of(const SearchSpace& space,
                                const Point& point,
                                const Outcome& outcome,
                                const std::string& score,
                                double factor) {
  const auto it = outcome.gradients.find(score);
  if (it == outcome.gradients.end() || it->second.size() != point.size()) {
    return {};
  }
  std::vector<double> gradient(point.size(), 0.0);
  for (std::size_t i = 0; i < point.size(); ++i) {
    const double scale = derivative_at(space, point, i);
    if (scale == 0.0) {
      continue;
    }
    if (!std::isfinite(it->second[i])) {
      return {};
    }
    gradient[i] = std::clamp(factor * it->second[i] * scale, -kMaxMerit, kMaxMerit);
  }
  return gradient;
}

/// Names of the variables by which a derivative is needed and missing.
std::vector<std::string> missing_derivatives(const SearchSpace& space,
                                             const Point& point,
                                             const Outcome& outcome,
                                             const std::string& score) {
  const auto it = outcome.gradients.find(score);
  const bool has_gradient =
      it != outcome.gradients.end() && it->second.size() == space.variables.size();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < point.size(); ++i) {
    const bool is_known = has_gradient && std::isfinite(it->second[i]);
    if (!is_known && derivative_at(space, point, i) != 0.0) {
      names.push_back(space.variables[i].name);
    }
  }
  return names;
}

void clear_if_unknown(std::vector<double>& errors) {
  if (std::ranges::all_of(errors, [](double error) { return std::isnan(error); })) {
    errors.clear();
  }
}

std::string problem_with_score(const Scores& scores,
                               const std::string& name,
                               bool may_be_infinite) {
  const auto it = scores.find(name);
  if (it == scores.end()) {
    return "there is no score \"" + name + "\"";
  }
  const bool is_good = may_be_infinite ? !std::isnan(it->second) : std::isfinite(it->second);
  return is_good ? ""
                 : "score \"" + name + "\" is " + (std::isnan(it->second) ? "NaN" : "infinite");
}

}  // namespace

std::string problem_with(const Goal& goal, const Scores& scores) {
  std::string problem;
  for (const Objective& objective : objectives_of(goal)) {
    if (problem.empty()) {
      problem = problem_with_score(scores, objective.name, false);
    }
  }
  for (const Constraint& constraint : goal.constraints) {
    if (problem.empty()) {
      problem = problem_with_score(scores, constraint.name, true);
    }
  }
  return problem;
}

std::string problem_with_gradients(const SearchSpace& space,
                                   const Goal& goal,
                                   const Point& point,
                                   const Outcome& outcome) {
  std::vector<std::string> scores = {goal.objective.name};
  for (const Constraint& constraint : goal.constraints) {
    if (violation(constraint, outcome.scores.at(constraint.name)) > 0.0) {
      scores.push_back(constraint.name);
    }
  }
  for (const std::string& score : scores) {
    const std::vector<std::string> names = missing_derivatives(space, point, outcome, score);
    if (!names.empty()) {
      return "no derivative of " + score + " by " + join(names, ", ");
    }
  }
  return "";
}

std::string problem_without_derivatives(const SearchSpace& space,
                                        const Goal& goal,
                                        const Point& point,
                                        const Outcome& outcome) {
  std::vector<std::string> scores = {goal.objective.name};
  std::ranges::transform(goal.constraints, std::back_inserter(scores), &Constraint::name);
  bool has_smooth = false;
  for (std::size_t i = 0; i < point.size(); ++i) {
    has_smooth = has_smooth || derivative_at(space, point, i) != 0.0;
    for (const std::string& score : scores) {
      const auto it = outcome.gradients.find(score);
      if (derivative_at(space, point, i) != 0.0 && it != outcome.gradients.end() &&
          it->second.size() == point.size() && std::isfinite(it->second[i])) {
        return "";
      }
    }
  }
  if (!has_smooth) {
    return "";
  }
  const std::string why = outcome.remarks.empty() ? "" : " (" + text_of(outcome.remarks) + ")";
  return "no derivative of " + join(scores, ", ") +
         ", which search.derivatives asks for; allowed here: search.derivatives = false" + why;
}

int num_limits(const Goal& goal) {
  int count = 0;
  for (const Constraint& constraint : goal.constraints) {
    count += (constraint.min ? 1 : 0) + (constraint.max ? 1 : 0);
  }
  return count;
}

std::vector<double> limit_values(const Constraint& constraint, double score) {
  std::vector<double> values;
  for (const Limit& limit : limits_of(constraint)) {
    const double factor = limit.sign / unit_of(limit.border);
    const double excess = factor * (score - limit.border) + limit.margin;
    values.push_back(std::clamp(excess, -kMaxViolation, kMaxViolation));
  }
  return values;
}

double score_at_limit(const Constraint& constraint, std::size_t limit, double value) {
  const Limit one = limits_of(constraint).at(limit);
  return one.border + one.sign * unit_of(one.border) * (value - one.margin);
}

double violation(const Constraint& constraint, double score) {
  if (constraint.min && score < *constraint.min) {
    return relative(*constraint.min - score, *constraint.min);
  }
  if (constraint.max && score > *constraint.max) {
    return relative(score - *constraint.max, *constraint.max);
  }
  return 0.0;
}

double violation(const Goal& goal, const Scores& scores) {
  double sum = 0.0;
  for (const Constraint& constraint : goal.constraints) {
    sum += constraint.weight * violation(constraint, scores.at(constraint.name));
  }
  return sum;
}

bool is_feasible(const Goal& goal, const Scores& scores) {
  return std::ranges::all_of(goal.constraints, [&scores](const Constraint& constraint) {
    return violation(constraint, scores.at(constraint.name)) <= 0.0;
  });
}

std::vector<double> minimised_objectives(const Goal& goal, const Scores& scores) {
  std::vector<double> values = {minimised(goal.objective, scores)};
  for (const Objective& objective : goal.more_objectives) {
    values.push_back(minimised(objective, scores));
  }
  return values;
}

bool is_better(const Goal& goal, const Scores& a, const Scores& b) {
  const double violation_a = violation(goal, a);
  const double violation_b = violation(goal, b);
  if (violation_a > 0.0 || violation_b > 0.0) {
    return violation_a < violation_b;
  }
  return has_several_objectives(goal)
             ? dominates(minimised_objectives(goal, a), minimised_objectives(goal, b))
             : minimised(goal.objective, a) < minimised(goal.objective, b);
}

double objective_noise(const Objective& objective, const Scores& scores) {
  std::string name = objective.name;
  for (const std::string_view end : {".low", ".high"}) {
    if (name.ends_with(end)) {
      name.resize(name.size() - end.size());
      break;
    }
  }
  const auto of = [&](const char* end) {
    const auto found = scores.find(name + end);
    return found == scores.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
  };
  const double half_width = 0.5 * (of(".high") - of(".low"));
  const double error = kErrorsPerHalf * of(".error");
  return std::hypot(std::isfinite(half_width) ? std::max(0.0, half_width) : 0.0,
                    std::isfinite(error) ? std::max(0.0, error) : 0.0);
}

double difference_noise(const Objective& objective, const Scores& a, const Scores& b) {
  return std::hypot(objective_noise(objective, a), objective_noise(objective, b));
}

bool is_surely_better(const Goal& goal, const Scores& a, const Scores& b) {
  const bool is_feasible_pair = is_feasible(goal, a) && is_feasible(goal, b);
  if (!is_feasible_pair || (!has_several_objectives(goal) && !is_better(goal, a, b))) {
    return is_better(goal, a, b);
  }
  return std::ranges::any_of(objectives_of(goal), [&](const Objective& objective) {
    const double lead = minimised(objective, b) - minimised(objective, a);
    return lead > difference_noise(objective, a, b);
  });
}

MeritFunction::MeritFunction(SearchSpace space,
                             Goal goal,
                             FailurePolicy policy,
                             int num_scale,
                             bool holds_unknown,
                             bool takes_intervals)
    : space_(std::move(space)),
      goal_(std::move(goal)),
      policy_(policy),
      num_scale_(num_scale),
      holds_unknown_(holds_unknown),
      takes_intervals_(takes_intervals) {}

Answer MeritFunction::next(const Point& point, const Outcome& outcome) {
  std::vector<double> unit = unit_from_point(space_, point);
  ++num_told_;
  if (outcome.is_failed) {
    return {.merit = failed_merit(unit), .is_failed = true};
  }
  const std::vector<double> objectives = minimised_objectives(goal_, outcome.scores);
  if (num_told_ <= num_scale_ || smallest_.empty()) {
    widen_spread(objectives);
  }
  double penalty = 0.0;
  for (const Constraint& constraint : goal_.constraints) {
    const double part = violation(constraint, outcome.scores.at(constraint.name));
    penalty += constraint.weight * std::log1p(part);
  }
  const double merit = combined(objectives) + penalty_scale() * penalty;
  told_.push_back({std::move(unit), std::clamp(merit, -kMaxMerit, kMaxMerit)});
  Answer answer{.merit = told_.back().merit,
                .objective = {.value = std::clamp(objectives[0], -kMaxMerit, kMaxMerit)}};
  for (const double objective : objectives) {
    answer.objectives.push_back(std::clamp(objective, -kMaxMerit, kMaxMerit));
  }
  answer.errors = standard_errors(outcome.scores);
  if (!outcome.gradients.empty()) {
    const double sign = goal_.objective.is_maximised ? -1.0 : 1.0;
    answer.objective.gradient = gradient_of(space_, point, outcome, goal_.objective.name, sign);
  }
  add_limits(point, outcome, answer);
  return answer;
}

double MeritFunction::standard_error(const Scores& scores, const std::string& name) const {
  if (const auto own = scores.find(name + ".error");
      own != scores.end() && std::isfinite(own->second)) {
    return std::abs(own->second);
  }
  const double noise = takes_intervals_ ? objective_noise({.name = name}, scores) : 0.0;
  return noise > 0.0 ? noise / kErrorsPerHalf : std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> MeritFunction::standard_errors(const Scores& scores) const {
  std::vector<double> errors;
  for (const Objective& objective : objectives_of(goal_)) {
    errors.push_back(standard_error(scores, objective.name));
  }
  clear_if_unknown(errors);
  return errors;
}

void MeritFunction::add_limits(const Point& point, const Outcome& outcome, Answer& answer) const {
  for (const Constraint& constraint : goal_.constraints) {
    const double score = outcome.scores.at(constraint.name);
    const double error = standard_error(outcome.scores, constraint.name);
    const std::vector<double> values = limit_values(constraint, score);
    std::size_t next = 0;
    for (const Limit& limit : limits_of(constraint)) {
      const double factor = limit.sign / unit_of(limit.border);
      ValueWithGradient told{
          .value = values[next++],
          .gradient = gradient_of(space_, point, outcome, constraint.name, factor)};
      if (holds_unknown_ && told.gradient.empty() && !outcome.gradients.empty()) {
        told.gradient.assign(point.size(), 0.0);
        told.value = std::min(told.value, 0.0);
      }
      answer.limits.push_back(std::move(told));
      answer.limit_errors.push_back(error / unit_of(limit.border));
    }
  }
  clear_if_unknown(answer.limit_errors);
}

void MeritFunction::widen_spread(const std::vector<double>& objectives) {
  if (smallest_.empty()) {
    smallest_ = objectives;
    largest_ = objectives;
  }
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    smallest_[i] = std::min(smallest_[i], objectives[i]);
    largest_[i] = std::max(largest_[i], objectives[i]);
  }
}

double MeritFunction::spread(std::size_t objective) const {
  if (smallest_.empty()) {
    return 1.0;
  }
  const double smallest = smallest_[objective];
  const double spread = largest_[objective] - smallest;
  // One value alone has no spread; its size is the best guess then.
  const double fallback = smallest != 0.0 ? std::abs(smallest) : 1.0;
  return spread > 0.0 ? spread : fallback;
}

double MeritFunction::combined(const std::vector<double>& objectives) const {
  if (objectives.size() == 1) {
    return objectives[0];
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    sum += objectives[i] / spread(i);
  }
  return sum / static_cast<double>(objectives.size());
}

double MeritFunction::penalty_scale() const {
  return kPenaltyFactor * (has_several_objectives(goal_) ? 1.0 : spread(0));
}

double MeritFunction::failed_merit(const std::vector<double>& unit) const {
  if (told_.empty()) {
    return kUnknownMerit;
  }
  if (policy_ == FailurePolicy::kWorst) {
    return std::ranges::max_element(told_, {}, &Told::merit)->merit;
  }
  double nearest = std::numeric_limits<double>::infinity();
  double merit = 0.0;
  for (const Told& told : told_) {
    double squared = 0.0;
    for (std::size_t i = 0; i < unit.size(); ++i) {
      squared += (told.unit[i] - unit[i]) * (told.unit[i] - unit[i]);
    }
    if (squared < nearest) {
      nearest = squared;
      merit = told.merit;
    }
  }
  return merit;
}

}  // namespace glint

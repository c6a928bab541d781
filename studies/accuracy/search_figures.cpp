// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/search_figures.h"

#include <algorithm>
#include <cmath>

#include "optimizer/algorithm/merit.h"

namespace glint {
namespace {

constexpr double kErrorsPerHalf = 2.0;  // as objective_noise()

double penalty(const Constraint& constraint, double score) {
  return constraint.weight * std::log1p(violation(constraint, score));
}

/// Of one unit of penalty in a figure. @param objective  minimised
double penalty_scale(std::span<const double> objective) {
  const auto [low, high] = std::ranges::minmax(objective);
  return MeritFunction::kPenaltyFactor * (high - low);
}

/// Half of what a standard error to both sides moves the penalty by: a limit may lie between them.
double penalty_error(const Constraint& constraint, const Scores& scores) {
  const double error = objective_noise({.name = constraint.name}, scores) / kErrorsPerHalf;
  const double score = scores.at(constraint.name);
  return 0.5 * std::abs(penalty(constraint, score + error) - penalty(constraint, score - error));
}

/// What figures are equal within.
double rounding_of(std::span<const double> figures) {
  constexpr double kOfSpread = 1e-6;
  constexpr double kOfSize = 1e-12;
  const auto [low, high] = std::ranges::minmax(figures);
  return kOfSpread * (high - low) + kOfSize * std::max(std::abs(low), std::abs(high));
}

/// Of each design by one objective, without rounding. @param scale  penalty_scale(); 0: no limits
std::vector<double> noise_of(const Goal& goal,
                             const Objective& objective,
                             std::span<const Scores> designs,
                             double scale) {
  std::vector<double> errors;
  for (const Scores& scores : designs) {
    double error = objective_noise(objective, scores) / kErrorsPerHalf;
    if (scale > 0.0) {
      for (const Constraint& constraint : goal.constraints) {
        error = std::hypot(error, scale * penalty_error(constraint, scores));
      }
    }
    errors.push_back(error);
  }
  return errors;
}

std::vector<std::vector<double>> objective_figures(const Goal& goal,
                                                   std::span<const Scores> designs) {
  std::vector<std::vector<double>> figures(objectives_of(goal).size());
  for (const Scores& scores : designs) {
    const std::vector<double> values = minimised_objectives(goal, scores);
    for (std::size_t k = 0; k < values.size(); ++k) {
      figures[k].push_back(values[k]);
    }
  }
  return figures;
}

}  // namespace

std::vector<std::vector<double>> search_figures(const Goal& goal, std::span<const Scores> designs) {
  std::vector<std::vector<double>> figures = objective_figures(goal, designs);
  if (figures.size() == 1 && !designs.empty()) {
    const double scale = penalty_scale(figures.front());
    for (std::size_t i = 0; i < designs.size(); ++i) {
      for (const Constraint& constraint : goal.constraints) {
        figures.front()[i] += scale * penalty(constraint, designs[i].at(constraint.name));
      }
    }
  }
  return figures;
}

std::vector<std::vector<double>> search_figure_errors(const Goal& goal,
                                                      std::span<const Scores> designs) {
  const std::vector<Objective> objectives = objectives_of(goal);
  if (designs.empty()) {
    return std::vector<std::vector<double>>(objectives.size());
  }
  const auto figures = search_figures(goal, designs);
  const double scale =
      objectives.size() == 1 ? penalty_scale(objective_figures(goal, designs).front()) : 0.0;
  std::vector<std::vector<double>> errors;
  for (std::size_t k = 0; k < objectives.size(); ++k) {
    errors.push_back(noise_of(goal, objectives[k], designs, scale));
    for (double& error : errors.back()) {
      error = std::hypot(error, rounding_of(figures[k]));
    }
  }
  return errors;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/score_model.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "optimizer/analysis/surrogate_indices.h"
#include "optimizer/surrogate/gaussian_process.h"
#include "studies/analysis/branches.h"
#include "studies/analysis/responses.h"

namespace glint {
namespace {

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
  const FittedScore& fitted;
  const BestDesigns& best;
  std::vector<std::string> branches;  ///< of each of the fitted points
  std::vector<Posterior> without_itself;
};

BranchAnalysis analyse_branch(const Question& question, const Branch& branch) {
  std::vector<std::size_t> members;
  std::vector<std::vector<double>> units;
  const FittedScore& fitted = question.fitted;
  for (std::size_t k = 0; k < fitted.points.size(); ++k) {
    if (question.branches[k] == branch.name) {
      members.push_back(k);
      units.push_back(branch.unit_of(question.space, fitted.points[k]));
    }
  }
  const std::optional<double> q2 = q2_of(question.without_itself, fitted.values, members);
  const auto dimension = static_cast<int>(branch.free.size());
  BranchAnalysis analysis = {
      .name = branch.name, .evidence = evidence_of(q2, units, dimension), .map = {}};
  if (!analysis.evidence.is_enough() || dimension == 0) {
    return analysis;
  }
  analysis.importance = importance_of(fitted.model, question.space, branch);
  const auto best = question.best.find(branch.name);
  const ResponseModel responses(
      fitted.model,
      question.space,
      branch,
      best != question.best.end() ? std::optional(best->second) : std::nullopt);
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
                            const FittedScore& fitted,
                            const BestDesigns& best) {
  ScoreAnalysis analysis = {.score = fitted.score,
                            .points = static_cast<int>(fitted.points.size()),
                            .left_out = fitted.left_out,
                            .without = fitted.without};
  Question question = {.space = space,
                       .fitted = fitted,
                       .best = best,
                       .branches = branch_names(space, fitted.points),
                       .without_itself = {}};
  if (!fitted.points.empty()) {
    analysis.q2 = fitted.model.leave_one_out_q2();
    analysis.noise = fitted.model.noise();
    question.without_itself = fitted.model.leave_one_out();
  }
  const std::vector<Branch> branches = branches_of(space, fitted.points);
  int wanted = 0;
  for (const Branch& branch : branches) {
    analysis.branches.push_back(analyse_branch(question, branch));
    wanted = std::max(wanted, analysis.branches.back().evidence.wanted);
  }
  analysis.wanted = wanted * static_cast<int>(branches.size());
  const bool are_covered = std::ranges::all_of(
      analysis.branches, [](const BranchAnalysis& one) { return one.evidence.is_covered; });
  if (branches.size() > 1 && are_covered && analysis.q2 >= kNeededQ2) {
    analysis.choices = importance_of_choices(fitted.model, space);
  }
  return analysis;
}

ScoreAnalysis analyse_score(const SearchSpace& space,
                            const Goal& goal,
                            std::span<const Trial> trials,
                            const std::string& score) {
  return analyse_score(space, fit_score(space, trials, score), best_seen(space, goal, trials));
}

}  // namespace glint

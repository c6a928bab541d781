// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/search_figures.h"

#include <algorithm>
#include <cmath>

#include "optimizer/algorithm/merit.h"

namespace glint {

std::vector<std::vector<double>> search_figures(const Goal& goal, std::span<const Scores> designs) {
  std::vector<std::vector<double>> figures(objectives_of(goal).size());
  for (const Scores& scores : designs) {
    const std::vector<double> values = minimised_objectives(goal, scores);
    for (std::size_t k = 0; k < values.size(); ++k) {
      figures[k].push_back(values[k]);
    }
  }
  if (figures.size() == 1 && !designs.empty()) {
    const auto [low, high] = std::ranges::minmax(figures.front());
    const double scale = MeritFunction::kPenaltyFactor * (high - low);
    for (std::size_t i = 0; i < designs.size(); ++i) {
      for (const Constraint& constraint : goal.constraints) {
        figures.front()[i] += scale * constraint.weight *
                              std::log1p(violation(constraint, designs[i].at(constraint.name)));
      }
    }
  }
  return figures;
}

}  // namespace glint

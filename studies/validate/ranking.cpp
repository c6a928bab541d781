// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/ranking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"

namespace glint {
namespace {

constexpr double kMinDifference = 0.02;  ///< differences of one view below this share are none
constexpr double kInterval = 1.96;

using Values = std::map<std::string, double>;

double mean_of_views(const Values& values) {
  double sum = 0.0;
  for (const auto& [view, value] : values) {
    sum += value;
  }
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

/// Values of the views that another one has, too.
Values common_with(const Values& other, Values values) {
  std::erase_if(values, [&other](const auto& view) { return !other.contains(view.first); });
  return values;
}

Estimate difference(const Values& first, const Values& second, double sign, double error) {
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  const Values ones = common_with(second, first);
  const Values others = common_with(first, second);
  if (ones.empty()) {
    return {.value = 0.0, .low = -kUnbounded, .high = kUnbounded};
  }
  std::vector<double> list;
  for (const auto& [view, value] : ones) {
    list.push_back(sign * (value - others.at(view)));
  }
  if (list.size() >= 3) {
    return mean_of(list);
  }
  const double a = mean_of_views(ones);
  const double b = mean_of_views(others);
  const double sigma = std::max(error / std::sqrt(static_cast<double>(list.size())),
                                kMinDifference * 0.5 * (std::abs(a) + std::abs(b)) / kInterval);
  const double value = sign * (a - b);
  return {.value = value, .low = value - kInterval * sigma, .high = value + kInterval * sigma};
}

bool holds_zero(const Estimate& estimate) {
  return estimate.low <= 0.0 && estimate.high >= 0.0;
}

std::vector<std::string> order_of(const std::vector<RankedDesign>& designs,
                                  Values RankedDesign::*side,
                                  double sign) {
  Values common = designs.empty() ? Values() : designs.front().*side;
  for (const RankedDesign& design : designs) {
    common = common_with(design.*side, std::move(common));
  }
  std::vector<std::pair<double, const RankedDesign*>> sorted;
  for (const RankedDesign& design : designs) {
    const Values& own = design.*side;
    sorted.emplace_back(sign * mean_of_views(common.empty() ? own : common_with(common, own)),
                        &design);
  }
  std::ranges::stable_sort(sorted, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> names;
  for (const auto& [mean, design] : sorted) {
    names.push_back(design->name);
  }
  return names;
}

/// @param by  " by defects.min_cnr" where there are several objectives
std::string ranking_text(const Ranking& ranking, const std::string& by) {
  if (ranking.pairs.empty()) {
    return "";
  }
  if (!ranking.agrees) {
    return fmt::format(" The real order of the designs{} is another: {} instead of {}.",
                       by,
                       join(ranking.real, ", "),
                       join(ranking.simulated, ", "));
  }
  return fmt::format(" The ranking of the designs{} holds {}.",
                     by,
                     std::ranges::any_of(ranking.pairs, &RankedPair::is_level)
                         ? "as far as it can be decided"
                         : "in reality");
}

}  // namespace

Ranking rank_designs(const std::vector<RankedDesign>& designs, bool is_maximised) {
  const double sign = is_maximised ? 1.0 : -1.0;
  Ranking ranking = {.simulated = order_of(designs, &RankedDesign::simulated, sign),
                     .real = order_of(designs, &RankedDesign::real, sign)};
  for (std::size_t i = 0; i < designs.size(); ++i) {
    for (std::size_t k = i + 1; k < designs.size(); ++k) {
      const RankedDesign& a = designs[i];
      const RankedDesign& b = designs[k];
      const double error = std::hypot(a.simulated_error, b.simulated_error);
      RankedPair pair = {.first = a.name,
                         .second = b.name,
                         .simulated = difference(a.simulated, b.simulated, sign, error),
                         .real = difference(a.real, b.real, sign, error)};
      pair.is_level = holds_zero(pair.simulated) || holds_zero(pair.real);
      pair.is_against = !pair.is_level && pair.simulated.value * pair.real.value < 0.0;
      ranking.agrees = ranking.agrees && !pair.is_against;
      ranking.pairs.push_back(std::move(pair));
    }
  }
  return ranking;
}

RankingSheet::RankingSheet(const std::optional<Study>& study) {
  if (study && study->has_objective) {
    objectives_ = objectives_of(study->goal);
  } else {
    objectives_ = {{.name = "homogeneity.h_rms", .is_maximised = true}};
    no_objective_ = study ? "the study has no objective" : "the run has no study.resolved.toml";
  }
  designs_.resize(objectives_.size());
}

void RankingSheet::add(const std::string& design, const std::string& view, const BothScores& both) {
  for (std::size_t i = 0; i < objectives_.size(); ++i) {
    const std::string& name = objectives_[i].name;
    if (!both.simulated.contains(name) || !both.real.contains(name)) {
      continue;
    }
    auto known = std::ranges::find(designs_[i], design, &RankedDesign::name);
    if (known == designs_[i].end()) {
      known = designs_[i].insert(known, {.name = design});
    }
    known->simulated[view] = both.simulated.at(name);
    known->real[view] = both.real.at(name);
    if (const auto error = both.simulated.find(name + ".error"); error != both.simulated.end()) {
      known->simulated_error = error->second;
    }
  }
}

ObjectiveRanking RankingSheet::ranking_by(std::size_t objective, std::size_t designs) const {
  const std::vector<RankedDesign>& known = designs_[objective];
  const Objective& wanted = objectives_[objective];
  ObjectiveRanking found = {.objective = wanted.name, .is_maximised = wanted.is_maximised};
  if (!no_objective_.empty()) {
    found.reason = no_objective_;
  } else if (designs < 2) {
    found.reason = "one design alone has pictures";
  } else if (known.size() < 2) {
    found.reason = fmt::format("{} of {} designs have this score of real pictures",
                               known.empty() ? "none" : "one",
                               designs);
  } else {
    found.ranking = rank_designs(known, wanted.is_maximised);
  }
  return found;
}

std::vector<ObjectiveRanking> RankingSheet::rankings(std::size_t designs) const {
  std::vector<ObjectiveRanking> all;
  for (std::size_t i = 0; i < objectives_.size(); ++i) {
    all.push_back(ranking_by(i, designs));
  }
  return all;
}

std::string rankings_text(const std::vector<ObjectiveRanking>& rankings, bool is_explained) {
  std::string text;
  bool is_held = false;
  for (const ObjectiveRanking& by : rankings) {
    if (by.ranking) {
      text += ranking_text(*by.ranking, rankings.size() > 1 ? " by " + by.objective : "");
    }
    is_held = is_held || (by.ranking && by.ranking->agrees && !by.ranking->pairs.empty());
  }
  return is_held && !is_explained ? text + " Until the cause is set right it is not proven." : text;
}

}  // namespace glint

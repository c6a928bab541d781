// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/tolerance/tolerance_spread.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "optimizer/algorithm/merit.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

Json spread_of(double nominal, std::vector<double> values) {
  std::ranges::sort(values);
  const auto count = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) {
    mean += value / count;
  }
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(std::lround(share * (count - 1.0)))];
  };
  return {{"nominal", nominal},
          {"mean", mean},
          {"sd", std::sqrt(squares / std::max(1.0, count - 1.0))},
          {"low", at(0.05)},
          {"high", at(0.95)}};
}

/// The spread of each score that the goal names.
Json spreads_of(const Goal& goal, const Scores& nominal, const std::vector<Scores>& found) {
  Json scores = Json::object();
  for (const std::string& name : named_scores(goal)) {
    std::vector<double> values;
    for (const Scores& one : found) {
      if (const auto score = one.find(name); score != one.end() && std::isfinite(score->second)) {
        values.push_back(score->second);
      }
    }
    if (!values.empty() && nominal.contains(name)) {
      scores[name] = spread_of(nominal.at(name), std::move(values));
    }
  }
  return scores;
}

std::vector<Scores> succeeded(const BuiltScores& built) {
  std::vector<Scores> found;
  for (const std::optional<Scores>& scores : built) {
    if (scores) {
      found.push_back(*scores);
    }
  }
  return found;
}

/// Of all built ones: one that cannot be evaluated meets no limit.
void add_feasible_share(const Goal& goal, const BuiltScores& built, Json& json) {
  if (!goal.constraints.empty() && !built.empty()) {
    const auto feasible = std::ranges::count_if(
        built, [&](const std::optional<Scores>& one) { return one && is_feasible(goal, *one); });
    json["feasible_share"] = static_cast<double>(feasible) / static_cast<double>(built.size());
  }
}

/// Infinite where a limit is the trouble.
Json number_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// In the unit of the measure. @param is_maximised  the merit is the negated score
Json interval_json(const BuiltInterval& interval, bool is_maximised) {
  return is_maximised ? Json{{"value", number_json(-interval.value)},
                             {"low", number_json(-interval.high)},
                             {"high", number_json(-interval.low)}}
                      : Json{{"value", number_json(interval.value)},
                             {"low", number_json(interval.low)},
                             {"high", number_json(interval.high)}};
}

Json candidates_json(const RobustOptimum& found, double sign, const WriteVariables& variables) {
  Json list = Json::array();
  for (std::size_t k = 1; k < found.candidates.size(); ++k) {
    const RobustCandidate& candidate = found.candidates[k];
    list.push_back({{"variables", variables(candidate.point)},
                    {"designs", candidate.built.size()},
                    {"modelled", number_json(sign * candidate.modelled.value_or(0.0))},
                    {"reached", number_json(sign * candidate.standing.reached)},
                    {"given_up", candidate.built.size() < kToleranceDesigns}});
  }
  return list;
}

Json robust_json(const Study& study,
                 const RobustOptimum& found,
                 const Scores& nominal,
                 const WriteVariables& variables) {
  const bool has_several = has_several_objectives(study.goal);
  const bool is_maximised = !has_several && study.goal.objective.is_maximised;
  const RobustCandidate& best = found.candidates[found.best];
  const std::vector<Scores> built = succeeded(best.built);
  Json json = {
      {"is_winner", found.best == 0},
      {"share", 1.0 - kWorstShare},
      {"measure",
       has_several ? std::string(choice_rule_name(study.goal.choice)) : study.goal.objective.name},
      {"winner", interval_json(found.winner, is_maximised)},
      {"reached", interval_json(found.robust, is_maximised)},
      {"gain", interval_json(found.gain, false)},
      {"probability", found.probability},
      {"variables", variables(best.point)},
      {"failed", best.built.size() - built.size()},
      {"scores", spreads_of(study.goal, nominal, built)}};
  add_feasible_share(study.goal, best.built, json);
  json["candidates"] = candidates_json(found, is_maximised ? -1.0 : 1.0, variables);
  return json;
}

Json winner_json(const Study& study,
                 const std::vector<Tolerance>& tolerances,
                 const BuiltScores& built,
                 const Scores& nominal) {
  const std::vector<Scores> found = succeeded(built);
  Json json = {{"designs", built.size()},
               {"failed", built.size() - found.size()},
               {"distribution", "uniform"},
               {"plus_minus", Json::object()},
               {"scores", spreads_of(study.goal, nominal, found)}};
  for (const Tolerance& tolerance : tolerances) {
    json["plus_minus"][tolerance.key] = tolerance.plus_minus;
  }
  add_feasible_share(study.goal, built, json);
  return json;
}

/// What the answer of a noisy search was chosen by; empty: by what was seen.
Expectations expected_by_answer(const Study& study, const SearchResult& search) {
  if (!study.search.is_noisy) {
    return {};
  }
  return search.trade_off ? search.of_front() : search.expected;
}

}  // namespace

std::optional<Json> tolerance_spread(BuiltDesigns& designs,
                                     const Study& study,
                                     const std::vector<Trial>& trials,
                                     const Point& winner,
                                     const WriteVariables& variables,
                                     const SearchResult& search) {
  const RobustTask task = {.space = study.space,
                           .goal = study.goal,
                           .trials = trials,
                           .offsets = designs.variable_offsets(),
                           .is_noisy = study.search.is_noisy,
                           .seed = study.search.seed,
                           .front = search.trade_off ? search.trade_off->front : FrontRows{},
                           .expected = expected_by_answer(study, search),
                           .limits = search.limits};
  const std::vector<BuiltScores> nominal = designs.build({winner}, kExact, 1);
  const std::optional<RobustOptimum> found = find_robust_optimum(
      task, winner, [&](const std::vector<Point>& points, int first, int count) {
        return designs.build(points, first, count);
      });
  if (nominal.empty() || !found) {
    return std::nullopt;
  }
  const RobustCandidate& best = found->candidates[found->best];
  const std::vector<BuiltScores> of_best =
      found->best == 0 ? nominal : designs.build({best.point}, kExact, 1);
  if (of_best.empty()) {
    return std::nullopt;
  }
  Json json = winner_json(study,
                          designs.tolerances(),
                          found->candidates.front().built,
                          nominal[0][0].value_or(Scores{}));
  json["robust"] = robust_json(study, *found, of_best[0][0].value_or(Scores{}), variables);
  json["evaluations"] = found->evaluations + (found->best == 0 ? 1 : 2);
  return json;
}

}  // namespace glint

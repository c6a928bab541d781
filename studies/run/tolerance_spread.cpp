// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/tolerance_spread.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/algorithm/sobol.h"
#include "studies/definition/manufacture.h"
#include "studies/run/study_search.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// Keeps these designs apart from those that a search of the same seed begins with.
constexpr std::uint64_t kSpreadSeeds = 1ULL << 41;

/// The point's values with one more, or another, for this key.
void move_key(const Study& study, const std::string& key, double offset, Overrides& overrides) {
  auto found = std::ranges::find(overrides, key, &Overrides::value_type::first);
  if (found == overrides.end()) {
    overrides.emplace_back(key, *study.resolved.at_path(key));
    found = std::prev(overrides.end());
  }
  found->second = ConfigNode::from_number(found->second.number + offset);
}

/// Nothing for a design that cannot be made.
std::optional<Scores> scores_of(SceneStore& store, const Study& study, const Overrides& overrides) {
  try {
    Scores scores = evaluate(store, scene_with(study, overrides), {}, wanted_by(study.goal)).scores;
    return std::isfinite(scores.at(study.goal.objective.name)) ? std::optional(scores)
                                                               : std::nullopt;
  } catch (const IoError&) {
    throw;  // says nothing about the design
  } catch (const Error&) {
    return std::nullopt;
  }
}

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

std::set<std::string> named_scores(const Goal& goal) {
  std::set<std::string> names;
  for (const Objective& objective : objectives_of(goal)) {
    names.insert(objective.name);
  }
  for (const Constraint& constraint : goal.constraints) {
    names.insert(constraint.name);
  }
  return names;
}

Json json_of(const Study& study, const Scores& nominal, const std::vector<Scores>& found) {
  Json scores = Json::object();
  for (const std::string& name : named_scores(study.goal)) {
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
  Json json = {{"designs", kToleranceDesigns},
               {"failed", kToleranceDesigns - static_cast<int>(found.size())},
               {"distribution", "uniform"},
               {"plus_minus", Json::object()},
               {"scores", scores}};
  if (!study.goal.constraints.empty() && !found.empty()) {
    const auto feasible = std::ranges::count_if(
        found, [&](const Scores& one) { return is_feasible(study.goal, one); });
    json["feasible_share"] = static_cast<double>(feasible) / static_cast<double>(found.size());
  }
  return json;
}

}  // namespace

Json tolerance_spread(SceneStore& store, const Study& study, const Point& point) {
  std::vector<Problem> errors;
  const std::vector<Tolerance> tolerances = read_tolerances(study, errors);
  throw_if_any(errors);
  const Overrides nominal = overrides_of(study, point);
  const Sobol sequence(study.search.seed + kSpreadSeeds, static_cast<int>(tolerances.size()));
  std::vector<Scores> found;
  for (int k = 0; k < kToleranceDesigns; ++k) {
    const std::vector<double> unit = sequence.point(static_cast<std::uint32_t>(k));
    Overrides moved = nominal;
    for (std::size_t i = 0; i < tolerances.size(); ++i) {
      move_key(study, tolerances[i].key, (2.0 * unit[i] - 1.0) * tolerances[i].plus_minus, moved);
    }
    if (std::optional<Scores> scores = scores_of(store, study, moved)) {
      found.push_back(std::move(*scores));
    }
  }
  Json json = json_of(study, scores_of(store, study, nominal).value_or(Scores{}), found);
  for (const Tolerance& tolerance : tolerances) {
    json["plus_minus"][tolerance.key] = tolerance.plus_minus;
  }
  return json;
}

Json tolerance_panel(const Json& spread) {
  Json rows = Json::array();
  for (const auto& [name, one] : spread["scores"].items()) {
    Json row = {name};
    for (const char* figure : {"nominal", "mean", "sd", "low", "high"}) {
      row.push_back(fmt::format("{:.4g}", one[figure].get<double>()));
    }
    rows.push_back(row);
  }
  std::vector<std::string> keys;
  for (const auto& [key, plus_minus] : spread["plus_minus"].items()) {
    keys.push_back(fmt::format("{} \u00b1 {:.4g}", key, plus_minus.get<double>()));
  }
  std::string lead = fmt::format(
      "{} designs about the winner, evaluated with the noise of the search; each key spread evenly "
      "within its tolerance: {}.",
      spread["designs"].get<int>(),
      join(keys, ", "));
  if (spread.contains("feasible_share")) {
    lead += fmt::format(" {:.0f} % of them meet every limit.",
                        100.0 * spread["feasible_share"].get<double>());
  }
  if (const int failed = spread["failed"].get<int>(); failed > 0) {
    lead += fmt::format(" {} could not be evaluated.", failed);
  }
  return {{"id", "manufacture"},
          {"title", "As it will be built"},
          {"lead", lead},
          {"tables",
           {{{"caption", ""},
             {"head", {"score", "winner", "mean", "standard deviation", "5 %", "95 %"}},
             {"rows", rows}}}}};
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/results/judged_limits.h"

#include <cstddef>

#include <nlohmann/json.hpp>

#include "optimizer/algorithm/merit.h"
#include "studies/front/front_designs.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json limits_json(const Goal& goal, const JudgedLimits& judged) {
  Json scores = Json::object();
  for (std::size_t i = 0; i < goal.constraints.size(); ++i) {
    const Expectation& score = judged.expected.scores.at(i);
    scores[goal.constraints[i].name] = {{"value", score.mean}, {"sd", score.sd}};
  }
  return {{"probability", judged.expected.probability},
          {"by", judged.is_raced ? "replicates" : "model"},
          {"scores", scores}};
}

void add_judged_limits(const Goal& goal, const SearchResult& search, Json& best) {
  if (search.judged_limits) {
    best["feasible"] = search.is_feasible;
    best["limits"] = limits_json(goal, *search.judged_limits);
  }
}

void judge_limits(const Goal& goal, const Json& race, const std::string& key, Json& design) {
  if (goal.constraints.empty() || design.contains("feasible")) {
    return;
  }
  for (const Json& row : race.is_object() ? race["entrants"] : Json::array()) {
    if (row["key"] == key && row.contains("limits")) {
      design["feasible"] = row["keeps_limits"];
      design["limits"] = row["limits"];
      return;
    }
  }
  design["feasible"] = is_feasible(goal, scores_from_json(design["scores"]));
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/analysis_json.h"

#include <nlohmann/json.hpp>

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

Json importance_json(const SearchSpace& space, const std::vector<Importance>& importance) {
  Json list = Json::array();
  for (const Importance& one : importance) {
    list.push_back({{"variable", space.variables[one.variable].name},
                    {"first", one.index.first.value},
                    {"first_low", one.index.first.low},
                    {"first_high", one.index.first.high},
                    {"total", one.index.total.value},
                    {"total_low", one.index.total.low},
                    {"total_high", one.index.total.high}});
  }
  return list;
}

/// Choices as they are written.
Json values_json(const Variable& variable, const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) {
    if (variable.kind == Variable::Kind::kChoice) {
      list.push_back(variable.choices[static_cast<std::size_t>(value)]);
    } else {
      list.push_back(value);
    }
  }
  return list;
}

void add_bands(const std::vector<Band>& bands, const std::string& name, Json& json) {
  Json mean = Json::array();
  Json low = Json::array();
  Json high = Json::array();
  for (const Band& band : bands) {
    mean.push_back(band.mean);
    low.push_back(band.low);
    high.push_back(band.high);
  }
  json[name] = mean;
  json[name + "_low"] = low;
  json[name + "_high"] = high;
}

Json responses_json(const SearchSpace& space, const std::vector<Response>& responses) {
  Json list = Json::array();
  for (const Response& response : responses) {
    const Variable& variable = space.variables[response.variable];
    Json json = {{"variable", variable.name}, {"at", values_json(variable, response.at)}};
    add_bands(response.average, "average", json);
    add_bands(response.at_best, "best", json);
    list.push_back(json);
  }
  return list;
}

Json map_json(const SearchSpace& space, const std::optional<ResponseMap>& map) {
  if (!map) {
    return nullptr;
  }
  const Variable& x = space.variables[map->x];
  const Variable& y = space.variables[map->y];
  Json json = {{"x", x.name},
               {"y", y.name},
               {"at_x", values_json(x, map->at_x)},
               {"at_y", values_json(y, map->at_y)}};
  add_bands(map->values, "mean", json);
  return json;
}

Json branch_json(const SearchSpace& space, const BranchAnalysis& branch) {
  return {{"name", branch.name},
          {"q2", branch.evidence.q2},
          {"points", branch.evidence.points},
          {"is_enough", branch.evidence.is_enough()},
          {"wanted", branch.evidence.wanted},
          {"reason", branch.evidence.reason()},
          {"importance", importance_json(space, branch.importance)},
          {"responses", responses_json(space, branch.responses)},
          {"map", map_json(space, branch.map)}};
}

}  // namespace

Json analysis_json(const SearchSpace& space, const ScoreAnalysis& analysis) {
  Json branches = Json::array();
  for (const BranchAnalysis& branch : analysis.branches) {
    branches.push_back(branch_json(space, branch));
  }
  return {{"score", analysis.score},
          {"q2", analysis.q2},
          {"noise", analysis.noise},
          {"points", analysis.points},
          {"left_out", analysis.left_out},
          {"without", analysis.without},
          {"wanted", analysis.wanted},
          {"branches", branches},
          {"choices", importance_json(space, analysis.choices)}};
}

}  // namespace glint

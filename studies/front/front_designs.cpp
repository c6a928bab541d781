// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/front/front_designs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/rng.h"
#include "metrics/lighting_scores.h"
#include "metrics/scores.h"
#include "metrics/statistics/told_value.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/front/front.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using Row = std::vector<double>;

constexpr int kScoreDraws = 4000;  // of the scores' errors: 1 % of probability is 2 standard errors

double sign_of(const Objective& objective) {
  return objective.is_maximised ? -1.0 : 1.0;
}

/// The objectives of an object of scores, minimised; empty where one is missing.
Row row_of(const Goal& goal, const Json& scores) {
  Row row;
  for (const Objective& objective : objectives_of(goal)) {
    if (!scores.contains(objective.name) || !scores[objective.name].is_number()) {
      return {};
    }
    row.push_back(sign_of(objective) * scores[objective.name].get<double>());
  }
  return row;
}

/// Empty while the search has fixed none.
Row reference_of(const Goal& goal, const Json& front) {
  return row_of(goal, front["reference"]);
}

std::vector<double> contributions(const Goal& goal, const Json& front) {
  const Json& designs = front["designs"];
  const Row reference = reference_of(goal, front);
  std::vector<Row> rows;
  for (const Json& design : designs) {
    rows.push_back(row_of(goal, design["scores"]));
  }
  return reference.empty() ? std::vector<double>(rows.size(), 0.0)
                           : hypervolume_contributions(rows, reference);
}

/// The standard deviation of the scans with other noise.
std::optional<double> spread_of(const Json& values) {
  if (!values.is_array() || values.size() < 2) {
    return std::nullopt;
  }
  const auto count = static_cast<double>(values.size());
  double mean = 0.0;
  for (const Json& value : values) {
    mean += value.get<double>() / count;
  }
  double squares = 0.0;
  for (const Json& value : values) {
    squares += (value.get<double>() - mean) * (value.get<double>() - mean);
  }
  return std::sqrt(squares / (count - 1.0));
}

/// A design that was scored again and keeps the limits.
struct Rescored {
  Json* design = nullptr;
  Row searched;
  Row fresh;
  Row errors;  ///< empty where one is missing
};

std::vector<Rescored> rescored_of(const Goal& goal, Json& front) {
  std::vector<Rescored> found;
  for (Json& design : front["designs"]) {
    if (design.contains("rescored") && design.value("keeps_limits", true)) {
      const Row fresh = row_of(goal, design["rescored"]);
      if (!fresh.empty()) {
        Row errors = row_of(goal, design["rescored_errors"]);
        std::ranges::transform(errors, errors.begin(), [](double x) { return std::abs(x); });
        found.push_back({.design = &design,
                         .searched = row_of(goal, design["scores"]),
                         .fresh = fresh,
                         .errors = std::move(errors)});
      }
    }
  }
  return found;
}

/// How often each one is beaten by none when the scores move by their errors.
std::vector<double> shares_on_front(const std::vector<Rescored>& designs) {
  std::vector<int> unbeaten(designs.size(), 0);
  std::vector<Row> rows(designs.size());
  for (int draw = 0; draw < kScoreDraws; ++draw) {
    Rng rng(0, Stream::kResampling, static_cast<std::uint64_t>(draw));
    for (std::size_t k = 0; k < designs.size(); ++k) {
      rows[k] = designs[k].fresh;
      for (std::size_t i = 0; i < rows[k].size(); ++i) {
        rows[k][i] += designs[k].errors[i] * rng.normal();
      }
    }
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const bool is_beaten =
          std::ranges::any_of(rows, [&](const Row& other) { return dominates(other, rows[k]); });
      unbeaten[k] += is_beaten ? 0 : 1;
    }
  }
  std::vector<double> shares;
  std::ranges::transform(unbeaten, std::back_inserter(shares), [](int count) {
    return static_cast<double>(count) / kScoreDraws;
  });
  return shares;
}

double volume_of(const std::vector<Rescored>& designs, Row Rescored::*row, const Row& reference) {
  std::vector<Row> rows;
  std::ranges::transform(
      designs, std::back_inserter(rows), [&](const Rescored& one) { return one.*row; });
  return reference.empty() ? 0.0 : hypervolume(rows, reference);
}

/// Half the interval of the hypervolume by the fresh scores, from two standard errors of each as if
/// they were independent, to first order; empty where an error is missing.
std::optional<double> volume_noise(const std::vector<Rescored>& designs, const Row& reference) {
  std::vector<Row> rows;
  std::ranges::transform(designs, std::back_inserter(rows), &Rescored::fresh);
  const double volume = reference.empty() ? 0.0 : hypervolume(rows, reference);
  double squares = 0.0;
  for (std::size_t k = 0; k < designs.size(); ++k) {
    if (reference.empty() || designs[k].errors.size() != rows[k].size()) {
      return std::nullopt;
    }
    for (std::size_t i = 0; i < rows[k].size(); ++i) {
      rows[k][i] = designs[k].fresh[i] + 2.0 * designs[k].errors[i];
      squares += std::pow(hypervolume(rows, reference) - volume, 2);
      rows[k][i] = designs[k].fresh[i];
    }
  }
  return std::sqrt(squares);
}

/// Of the objectives that were scanned repeatedly. @param repeated  of scores.json
Json told_values(const Goal& goal, const Json& repeated, const Json& design) {
  Json told = Json::object();
  for (const Objective& objective : objectives_of(goal)) {
    const Json scans = repeated.value(objective.name, Json::array());
    if (scans.size() < 2) {
      continue;
    }
    const double error = design.value("errors", Json::object()).value(objective.name, 0.0);
    std::optional<ModelledScore> model;
    if (const Json known = design.value("expected", Json::object());
        known.contains(objective.name)) {
      model =
          ModelledScore{.mean = known[objective.name]["value"], .sd = known[objective.name]["sd"]};
    }
    const Estimate value = told_value(scans.get<std::vector<double>>(), error, model);
    told[objective.name] = {{"value", value.value}, {"low", value.low}, {"high", value.high}};
  }
  return told;
}

}  // namespace

Scores scores_from_json(const Json& json) {
  Scores scores;
  for (const auto& [name, value] : json.items()) {
    if (value.is_number()) {
      scores[name] = value.get<double>();
    }
  }
  return scores;
}

std::optional<double> fresh_error(const Json& written, const std::string& score) {
  constexpr double kErrorsPerWidth = 4.0;  // an interval of 95 %
  if (is_of_lighting(score) || is_of_coverage(score) || is_of_reach(score)) {
    return 0.0;
  }
  const Scores fresh = scores_from_json(written.value("rescored", Json::object()));
  if (const auto own = fresh.find(error_name(score)); own != fresh.end()) {
    return std::abs(own->second);
  }
  const Json repeated = written.value("repeated", Json::object());
  if (const auto spread = spread_of(repeated.value(score, Json()))) {
    return spread;
  }
  const std::string whole(without_bound(score));
  const auto low = fresh.find(whole + ".low");
  const auto high = fresh.find(whole + ".high");
  return low != fresh.end() && high != fresh.end()
             ? std::optional(std::abs(high->second - low->second) / kErrorsPerWidth)
             : std::nullopt;
}

void plan_front(const Goal& goal, Json& front) {
  Json& designs = front["designs"];
  const std::vector<double> worth = contributions(goal, front);
  const Json chosen = front["chosen"].is_object() ? front["chosen"]["trial"] : Json(nullptr);
  std::vector<std::size_t> order(designs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto is_chosen = [&](std::size_t k) { return designs[k]["trial"] == chosen; };
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return is_chosen(a) != is_chosen(b) ? is_chosen(a) : worth[a] > worth[b];
  });
  for (std::size_t place = 0; place < order.size(); ++place) {
    Json& design = designs[order[place]];
    const bool is_full = place < kFullDesigns;
    const bool is_shown = place < kFullDesigns + kThumbnailDesigns;
    design["contribution"] = worth[order[place]];
    design["shown"] = is_full ? "full" : is_shown ? "thumbnail" : "none";
    if (is_shown) {
      design["folder"] = is_chosen(order[place])
                             ? std::string("winner")
                             : fmt::format("front/trial_{:03}", design["trial"].get<int>());
    }
  }
}

void add_rescored(const Goal& goal, const Json& written, Json& design) {
  const Json fresh = written.value("rescored", Json());
  if (!fresh.is_object() || row_of(goal, fresh).empty()) {
    return;
  }
  const Json repeated = written.value("repeated", Json::object());
  Json scores = Json::object();
  Json errors = Json::object();
  for (const auto& [name, searched] : design["scores"].items()) {
    if (!fresh.contains(name)) {
      continue;
    }
    scores[name] = fresh[name];
    if (const auto error = fresh_error(written, name)) {
      errors[name] = *error;
    }
  }
  design["rescored"] = scores;
  design["rescored_errors"] = errors;
  if (Json told = told_values(goal, repeated, design); !told.empty()) {
    design["told"] = std::move(told);
  }
  if (!goal.constraints.empty()) {
    design["keeps_limits"] = is_feasible(goal, scores_from_json(fresh));
  }
}

Json judge_front(const Goal& goal, Json& front) {
  const std::vector<Rescored> designs = rescored_of(goal, front);
  int dominated = 0;
  for (const Rescored& one : designs) {
    const auto better = std::ranges::find_if(
        designs, [&](const Rescored& other) { return dominates(other.fresh, one.fresh); });
    if (better != designs.end()) {
      (*one.design)["dominated_by"] = (*better->design)["trial"];
      ++dominated;
    }
  }
  const bool has_errors = std::ranges::all_of(
      designs, [](const Rescored& one) { return one.errors.size() == one.fresh.size(); });
  if (has_errors) {
    const std::vector<double> shares = shares_on_front(designs);
    for (std::size_t k = 0; k < designs.size(); ++k) {
      (*designs[k].design)["probability_on_front"] = shares[k];
    }
  }
  const auto rescored = std::ranges::count_if(
      front["designs"], [](const Json& design) { return design.contains("rescored"); });
  const Row reference = reference_of(goal, front);
  const auto noise = volume_noise(designs, reference);
  return {{"designs", rescored},
          {"dominated", dominated},
          {"hypervolume", volume_of(designs, &Rescored::fresh, reference)},
          {"noise", noise ? Json(*noise) : Json(nullptr)},
          {"searched", volume_of(designs, &Rescored::searched, reference)}};
}

}  // namespace glint

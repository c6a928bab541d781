// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/manufacture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "studies/definition/study_tables.h"

namespace glint {
namespace {

Problem problem_at(const ConfigNode& node, const std::string& key, std::string text) {
  return {.kind = Problem::Kind::kOutOfRange,
          .place = node.place,
          .context = "manufacture",
          .key = key,
          .text = std::move(text)};
}

/// Both ends about the middle of the key's range, or about its value, must be values that the scene
/// takes. @return what it says about the first that is not
std::string refused_end(const Study& study, const Tolerance& tolerance) {
  double nominal = study.resolved.at_path(tolerance.key)->number;
  const auto variable = std::ranges::find(study.space.variables, tolerance.key, &Variable::name);
  if (variable != study.space.variables.end()) {
    if (2.0 * tolerance.plus_minus > variable->high - variable->low) {
      return fmt::format("plus_minus = {} is beyond the variable's range of {} to {}, at most {}",
                         tolerance.plus_minus,
                         variable->low,
                         variable->high,
                         0.5 * (variable->high - variable->low));
    }
    nominal = 0.5 * (variable->low + variable->high);
    nominal = tolerance.is_integer ? std::round(nominal) : nominal;
  }
  for (const double sign : {-1.0, 1.0}) {
    const double value = nominal + sign * tolerance.plus_minus;
    try {
      scene_with(study,
                 {{tolerance.key, moved_value(*study.resolved.at_path(tolerance.key), value)}});
    } catch (const ConfigError& error) {
      const Problem& first = error.problems().front();
      // Conditions between keys depend on the others, too.
      if (first.kind == Problem::Kind::kOutOfRange) {
        return fmt::format("plus_minus = {} is beyond the key's range: {} {}",
                           tolerance.plus_minus,
                           value,
                           first.text);
      }
    }
  }
  return "";
}

/// @return what is wrong with { plus_minus = .. } itself
std::string refused_value(const ConfigNode& node, bool is_integer) {
  const ConfigNode* value = node.is_table() ? node.find("plus_minus") : nullptr;
  if (value == nullptr || !value->is_number() || node.names.size() != 1) {
    return "must be a table { plus_minus = number > 0 }";
  }
  if (!(value->number > 0.0) || !std::isfinite(value->number)) {
    return fmt::format("plus_minus = {} must be > 0", value->number);
  }
  if (is_integer && value->number != std::floor(value->number)) {
    return fmt::format("plus_minus = {} must be a whole number, as the key's values are",
                       value->number);
  }
  return "";
}

}  // namespace

ConfigNode moved_value(const ConfigNode& node, double value) {
  return node.kind == ConfigNode::Kind::kInteger
             ? ConfigNode::from_integer(static_cast<std::int64_t>(std::llround(value)))
             : ConfigNode::from_number(value);
}

std::vector<Tolerance> read_tolerances(const Study& study, std::vector<Problem>& errors) {
  std::vector<Tolerance> tolerances;
  const ConfigNode* table = study.root.find("manufacture");
  if (table == nullptr) {
    return tolerances;
  }
  if (!table->is_table() || !study.has_search() || !study.has_objective) {
    errors.push_back({.kind = Problem::Kind::kRelation,
                      .place = table->place,
                      .key = "manufacture",
                      .text = "must be a table of \"path.to.key\" = { plus_minus = number } beside "
                              "[variables] and [objective]: it spreads the winner of a search"});
    return tolerances;
  }
  for (std::size_t i = 0; i < table->names.size(); ++i) {
    const std::string& key = table->names[i];
    const ConfigNode* node = study.resolved.at_path(key);
    if (node == nullptr) {
      errors.push_back(unknown_path(study, key, table->items[i].place));
      continue;
    }
    const bool is_integer = node->kind == ConfigNode::Kind::kInteger;
    std::string refused = node->is_number() ? refused_value(table->items[i], is_integer)
                                            : "must be a key whose value is a number";
    if (refused.empty()) {
      tolerances.push_back({.key = key,
                            .plus_minus = table->items[i].find("plus_minus")->number,
                            .is_integer = is_integer});
      refused = refused_end(study, tolerances.back());
    }
    if (!refused.empty()) {
      errors.push_back(problem_at(table->items[i], key, refused));
    }
  }
  return tolerances;
}

void check_has_tolerances(const Study& study) {
  const ConfigNode* table = study.root.find("manufacture");
  if (table != nullptr && table->names.empty()) {
    throw_if_any({{.kind = Problem::Kind::kRelation,
                   .place = table->place,
                   .key = "manufacture",
                   .text = "is empty, must name what cannot be built exactly: \"path.to.key\" = { "
                           "plus_minus = number > 0 }"}});
  }
}

}  // namespace glint

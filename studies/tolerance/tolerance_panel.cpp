// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/tolerance/tolerance_panel.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/report/report_wording.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using report_detail::Wording;

std::string number_text(const Json& value, const Wording& wording) {
  return value.is_number() ? wording.text(value.get<double>()) : "outside the limits";
}

/// "12.3 (95 %: 11.9 to 12.6)"
std::string interval_text(const Json& interval, const Wording& wording) {
  if (!interval["value"].is_number()) {
    return "none within the limits";
  }
  return fmt::format("{} (95 %: {} to {})",
                     number_text(interval["value"], wording),
                     number_text(interval["low"], wording),
                     number_text(interval["high"], wording));
}

/// Of built designs. @param whose  "" or " of ..."
std::string failed_text(const Json& spread, const char* whose) {
  const int failed = spread["failed"].get<int>();
  return failed == 0 ? ""
                     : fmt::format(
                           " {}{} could not be made or evaluated, and count{} as outside "
                           "every limit.",
                           failed,
                           whose,
                           failed == 1 ? "s" : "");
}

std::string lead_text(const Json& spread) {
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
  return lead + failed_text(spread, "");
}

/// What 95 % of the built designs reach, of the winner and of the robust optimum.
std::string robust_text(const Json& robust) {
  const std::size_t count = robust["candidates"].size();
  if (count == 0) {
    return " The trials are too few to propose a more robust design.";
  }
  const std::string tried = fmt::format(
      " Of {} more design{} that a model of the search proposed, built with the same deviations, ",
      count,
      count == 1 ? "" : "s");
  const Wording wording = Wording::of_score(robust["measure"]);
  if (robust["is_winner"].get<bool>()) {
    return tried + fmt::format(
                       "none is better: the winner is the robust optimum, too. 19 of 20 built ones "
                       "reach {} {} within every limit.",
                       wording.label(),
                       interval_text(robust["winner"], wording));
  }
  return tried +
         fmt::format(
             "one is more robust: 19 of 20 built ones reach {} {} within every limit, of the "
             "winner {}. It is the better of the two with a probability of {:.1f} %.",
             wording.label(),
             interval_text(robust["reached"], wording),
             interval_text(robust["winner"], wording),
             100.0 * robust["probability"].get<double>());
}

Json score_table(const std::string& caption, const std::string& design, const Json& scores) {
  Json rows = Json::array();
  for (const auto& [name, figures] : scores.items()) {
    const Wording wording = Wording::of_score(name);
    const Json& one = figures;
    const auto text = [&](const char* figure) { return number_text(one[figure], wording); };
    rows.push_back({wording.label(),
                    text("nominal"),
                    text("mean"),
                    one["sd"].is_number() ? wording.size(one["sd"].get<double>()) : text("sd"),
                    text("low"),
                    text("high")});
  }
  return {{"caption", caption},
          {"head", {"score", design, "mean", "standard deviation", "5 %", "95 %"}},
          {"rows", rows}};
}

std::string value_text(const Json& value) {
  return value.is_number_float() ? fmt::format("{:.5g}", value.get<double>())
         : value.is_string()     ? value.get<std::string>()
                                 : value.dump();
}

Json variable_table(const Json& winner, const Json& robust) {
  Json rows = Json::array();
  for (const auto& [name, value] : robust.items()) {
    rows.push_back(
        {name, winner.contains(name) ? value_text(winner[name]) : "-", value_text(value)});
  }
  return {{"caption", "Variables"}, {"head", {"", "winner", "robust optimum"}}, {"rows", rows}};
}

}  // namespace

Json tolerance_panel(const Json& spread, const Json& variables) {
  std::string lead = lead_text(spread);
  Json tables = Json::array();
  const Json robust = spread.value("robust", Json());
  const bool is_other = robust.is_object() && !robust["is_winner"].get<bool>();
  tables.push_back(score_table(is_other ? "The winner" : "", "winner", spread["scores"]));
  if (robust.is_object()) {
    lead += robust_text(robust);
  }
  if (is_other) {
    lead += failed_text(robust, " of those of the robust optimum");
    tables.push_back(score_table("The robust optimum", "exactly built", robust["scores"]));
    tables.push_back(variable_table(variables, robust["variables"]));
  }
  return {
      {"id", "manufacture"}, {"title", "As it will be built"}, {"lead", lead}, {"tables", tables}};
}

}  // namespace glint

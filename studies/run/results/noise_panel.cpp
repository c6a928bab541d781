// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/results/noise_panel.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/report/report_wording.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using report_detail::Wording;

std::string figure(const Json& row, const char* name, const Wording& wording) {
  return row.contains(name) && row[name].is_number() ? wording.text(row[name].get<double>())
                                                     : std::string("\u2013");
}

/// "80.1 % \u00b1 0.4 points"
std::string expected_text(const Json& row, const Wording& wording) {
  const bool has_deviation = row.contains("expected_sd") && row["expected_sd"].is_number();
  return figure(row, "expected", wording) +
         (has_deviation ? " \u00b1 " + wording.size(row["expected_sd"].get<double>())
                        : std::string());
}

std::string share_text(const Json& row) {
  return row["given_up"].get<bool>()
             ? std::string("given up")
             : fmt::format("{:.0f} %", 100.0 * row["probability"].get<double>());
}

std::string kept_text(const Json& row) {
  const std::string text = row["keeps_limits"].get<bool>() ? "yes" : "no";
  return row.contains("limits")
             ? fmt::format("{} ({:.0f} %)",
                           text,
                           std::floor(100.0 * row["limits"]["probability"].get<double>()))
             : text;
}

Json race_table(const Json& race, const Wording& wording) {
  Json rows = Json::array();
  for (const Json& row : race["entrants"]) {
    const std::string interval =
        figure(row, "low", wording) + " to " + figure(row, "high", wording);
    rows.push_back({row["title"],
                    figure(row, "searched", wording),
                    expected_text(row, wording),
                    std::to_string(row["replicates"].get<int>()),
                    figure(row, "value", wording),
                    interval,
                    kept_text(row),
                    share_text(row)});
  }
  return {{"caption", "The race of the finalists"},
          {"head",
           {"design",
            "seen by the search",
            "expected",
            "replicates",
            "mean",
            "95 %",
            "within limits",
            "best"}},
          {"rows", rows}};
}

std::string told_text(const Json& told, const Wording& wording) {
  std::string text = fmt::format(
      "The winner's {} is {} (95 %: {} to {}) over random numbers that "
      "nothing was chosen by; the search saw {}",
      wording.label(),
      figure(told, "value", wording),
      figure(told, "low", wording),
      figure(told, "high", wording),
      figure(told, "seen", wording));
  if (told.contains("expected")) {
    text += ", its model expects " + expected_text(told, wording);
  }
  return text + ".";
}

std::string race_text(const Json& race) {
  return fmt::format(
      " {} finalists raced with fresh random numbers, the same ones for all, and with what they "
      "are compared with: {} evaluations beside the search's, at most {} of a design. One that "
      "would lead in less than 1 % of the samples was given up.",
      race["finalists"].get<int>(),
      race["evaluations"].get<int>(),
      race["replicates"].get<int>());
}

}  // namespace

Json noise_panel(const std::string& score, const Json& race, const Json& told) {
  const Wording wording = Wording::of_score(score);
  std::string lead = told.is_object() ? told_text(told, wording) : std::string();
  Json tables = Json::array();
  if (race.is_object()) {
    lead += race_text(race);
    tables.push_back(race_table(race, wording));
  }
  return {{"id", "noise"}, {"title", "What noise leaves"}, {"lead", lead}, {"tables", tables}};
}

}  // namespace glint

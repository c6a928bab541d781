// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/accuracy_panel.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/accuracy/error_text.h"
#include "studies/report/report_wording.h"
#include "studies/report/score_words.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using report_detail::error_text;
using report_detail::measured;

/// @param accuracy    of the search, or of a branch
/// @param of          " of lighting_use = ring"; empty: of the search
/// @param confidence  of the bounds
Json rungs_table(const Json& accuracy, const std::string& of, double confidence) {
  Json rows = Json::array();
  const double top = accuracy["rungs"].back()["work"].get<double>();
  for (const Json& rung : accuracy["rungs"]) {
    std::vector<std::string> taus;
    for (const auto& [objective, tau] : rung["tau"].items()) {
      taus.push_back(fmt::format("{:.2f}", tau.get<double>()));
    }
    std::vector<std::string> bounds;
    for (const auto& [score, bound] : rung["bounds"].items()) {
      bounds.push_back(fmt::format(
          "{} {}", report_detail::score_label(score), error_text(score, bound.get<double>())));
    }
    const auto skipped = rung["skipped"].get<std::string>();
    std::string result = !skipped.empty()              ? "left out: " + skipped
                         : !rung["serves"].get<bool>() ? "not exact enough"
                                                       : "serves";
    if (rung["name"] == accuracy["rung"]) {
      result += ", used by the search";
    } else if (!rung["for_search"].get<bool>()) {
      result = "compared with";
    }
    rows.push_back({rung["name"],
                    measured(100.0 * rung["work"].get<double>() / top) + " %",
                    taus.empty() ? "-" : join(taus, ", "),
                    bounds.empty() ? "-" : join(bounds, "; "),
                    result});
  }
  return {
      {"caption",
       fmt::format("The ladder{}, tried on {} designs with the same random numbers: {}. Work is "
                   "counted, as a share of the last row's; bounds hold at a confidence of {:g} "
                   "%.",
                   of,
                   accuracy["designs"].size(),
                   join(accuracy["designs"].get<std::vector<std::string>>(), ", "),
                   100.0 * confidence)},
      {"head", {"way to render", "work", "Kendall's tau", "errors within", "result"}},
      {"rows", rows}};
}

std::string settings_text(const Json& settings) {
  std::vector<std::string> parts;
  for (const auto& [key, value] : settings.items()) {
    parts.push_back(
        fmt::format("{} = {}", key, value.is_string() ? value.get<std::string>() : value.dump()));
  }
  return join(parts, ", ");
}

std::string wish_text(const Json& accuracy) {
  const Json& tolerance = accuracy["tolerance"];
  std::vector<std::string> parts;
  if (tolerance.is_object()) {
    for (const auto& [score, text] : tolerance.items()) {
      parts.push_back(text.get<std::string>());
    }
  }
  return fmt::format("{}, at a confidence of {:g} %",
                     parts.empty() ? "\"auto\": the right order of designs" : join(parts, "; "),
                     100.0 * accuracy["confidence"].get<double>());
}

/// @param key  "bound" or "wide_bound"
std::string bounds_text(const Json& accuracy, const char* key) {
  std::vector<std::string> parts;
  for (const Json& score : accuracy["scores"]) {
    const auto name = score["score"].get<std::string>();
    parts.push_back(fmt::format("{} within {}",
                                report_detail::score_label(name),
                                error_text(name, score[key].get<double>())));
  }
  return parts.empty() ? "none: too few designs could be evaluated" : join(parts, "; ");
}

/// "12.3 million paths; 41 % of the search"
std::string cost_text(const Json& work, double amount) {
  const double search = work["search"].get<double>();
  const std::string share =
      search > 0.0 ? fmt::format("; {} % of the search", measured(100.0 * amount / search)) : "";
  return fmt::format("{} {}{}", measured(amount), work["unit"].get<std::string>(), share);
}

/// By the evaluations that there are; of one where their number is not known.
std::string search_text(const Json& work) {
  const double search = work["search"].get<double>();
  return search > 0.0 ? cost_text(work, search)
                      : fmt::format("{} for each evaluation",
                                    cost_text(work, work["evaluation"].get<double>()));
}

std::string full_text(const Json& work) {
  return work["search"].get<double>() > 0.0
             ? cost_text(work, work["full"].get<double>())
             : fmt::format("{} for each evaluation",
                           cost_text(work, work["full_evaluation"].get<double>()));
}

/// "lighting_use = ring"
std::string branch_label(const Json& accuracy, const Json& branch) {
  if (branch.contains("label")) {
    return branch["label"].get<std::string>();
  }
  return fmt::format(
      "{} = {}", accuracy["variable"].get<std::string>(), branch["value"].get<std::string>());
}

/// How the search is rendered: a row for each branch where there are some.
Json rendered_rows(const Json& accuracy) {
  if (!accuracy.contains("branches")) {
    return Json::array(
        {{"level", accuracy["level"]},
         {"rendered by", accuracy["rung"]},
         {"settings", settings_text(accuracy["settings"])},
         {"errors of one more design", bounds_text(accuracy, "bound")},
         {"of all designs, unchecked ones too", bounds_text(accuracy, "wide_bound")}});
  }
  Json rows = Json::array();
  for (const Json& branch : accuracy["branches"]) {
    rows.push_back({branch_label(accuracy, branch), branch["rung"]});
  }
  return rows;
}

/// A row for each branch.
Json branches_table(const Json& accuracy) {
  Json rows = Json::array();
  for (const Json& branch : accuracy["branches"]) {
    rows.push_back({branch["value"],
                    measured(100.0 * branch["share"].get<double>()) + " %",
                    branch["level"],
                    branch["rung"],
                    settings_text(branch["settings"]),
                    bounds_text(branch, "bound"),
                    bounds_text(branch, "wide_bound")});
  }
  return {{"caption", "Designs of each branch are rendered by a rung of their own:"},
          {"head",
           {accuracy["variable"],
            "designs",
            "level",
            "rendered by",
            "settings",
            "errors of one more design",
            "of all designs, unchecked ones too"}},
          {"rows", rows}};
}

/// What the section is about, in one place.
Json facts_table(const Json& accuracy) {
  const Json& work = accuracy["work"];
  Json rows = Json::array({{"asked for", wish_text(accuracy)}});
  for (const Json& row : rendered_rows(accuracy)) {
    rows.push_back(row);
  }
  rows.push_back({"the search takes", search_text(work)});
  rows.push_back({"choosing takes", cost_text(work, work["checking"].get<double>())});
  if (accuracy.contains("check")) {
    const Json& check = accuracy["check"];
    rows.push_back({"checked", check["sentence"]});
    rows.push_back({"checking took", cost_text(work, check["work"].get<double>())});
    rows.push_back(
        {"finalists at the top took", cost_text(work, check["finalist_work"].get<double>())});
  }
  rows.push_back({"full physics would have taken", full_text(work)});
  return {{"caption", "In one place; work is counted, not measured:"},
          {"head", {"what", "how"}},
          {"rows", rows}};
}

Json unmodelled_table(const Json& accuracy) {
  Json rows = Json::array();
  for (const Json& note : accuracy["not_modelled"]) {
    rows.push_back(Json::array({note}));  // Clang takes {note} for a copy of it
  }
  return {{"caption", "What no way to render models, with rough estimates:"},
          {"head", {"left out"}},
          {"rows", rows}};
}

/// With what its check came to, of a run that was finished.
std::string sentences(const Json& accuracy) {
  const auto sentence = accuracy["sentence"].get<std::string>();
  return accuracy.contains("check")
             ? sentence + " " + accuracy["check"]["sentence"].get<std::string>()
             : sentence;
}

}  // namespace

Json accuracy_panel(const Json& accuracy) {
  const double confidence = accuracy["confidence"].get<double>();
  Json tables = Json::array({facts_table(accuracy)});
  if (accuracy.contains("branches")) {
    tables.push_back(branches_table(accuracy));
    for (const Json& branch : accuracy["branches"]) {
      tables.push_back(rungs_table(branch, " of " + branch_label(accuracy, branch), confidence));
    }
  } else {
    tables.push_back(rungs_table(accuracy, "", confidence));
  }
  tables.push_back(unmodelled_table(accuracy));
  return {{"id", "accuracy"},
          {"title", "How exactly it was rendered"},
          {"lead", sentences(accuracy)},
          {"tables", tables}};
}

std::string accuracy_text(const Json& accuracy) {
  if (!accuracy.contains("branches")) {
    return fmt::format("  {}\n", sentences(accuracy));
  }
  std::vector<std::string> lines = accuracy["why"].get<std::vector<std::string>>();
  if (accuracy.contains("within_budget")) {
    lines.push_back(accuracy["within_budget"].get<std::string>());
  }
  if (accuracy.contains("check")) {
    lines.push_back(accuracy["check"]["sentence"].get<std::string>());
  }
  return fmt::format("  {}\n", fmt::join(lines, "\n  "));
}

}  // namespace glint

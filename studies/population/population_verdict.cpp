// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/population/population_verdict.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/population/population_text.h"
#include "studies/report/report_wording.h"

namespace glint {

using Json = nlohmann::ordered_json;

namespace {

using population_detail::a90_text;
using population_detail::largest_size;
using population_detail::share_text;
using population_detail::size_text;
using report_detail::measured;

std::string sorting_sentence(const Json& sorting) {
  const Json& baseline = sorting["designs"]["baseline"];
  const Json& alarms = baseline["false_alarms"];
  return fmt::format(
      "{} of {} tested parts are in the expert's class, {}; a flawless part has at most {} "
      "false alarms ({} on {} scans).",
      baseline["right"].get<int>(),
      baseline["tested"].get<int>(),
      share_text(baseline["share_right"]),
      measured(alarms["per_part"]["high"].get<double>()),
      alarms["blobs"].get<int>(),
      alarms["scans"].get<int>());
}

std::string pod_line(const Json& design, const std::string& unit) {
  const Json& fit = design["fit"];
  if (fit.is_null()) {
    return fmt::format("{}: no curve can be fitted", design["title"].get<std::string>());
  }
  return fmt::format("{}: a90 {} {}, a90/95 {} {}",
                     design["title"].get<std::string>(),
                     a90_text(fit, largest_size(design)),
                     unit,
                     size_text(fit["a90_95"], largest_size(design)),
                     unit);
}

double a90_of(const Json& design) {
  return design["fit"]["a90"]["value"].get<double>();
}

/// ", 13 times smaller than under Two panels"; no ratio where a curve goes beyond what was tried.
std::string than_text(const Json& best, const Json& worst, const std::string& unit) {
  const std::string title = worst["title"];
  const double largest = largest_size(worst);
  return a90_of(worst) > largest ? fmt::format("; under {} no size up to {} {} is found as often",
                                               title,
                                               measured(largest),
                                               unit)
                                 : fmt::format(", {} times smaller than under {}",
                                               measured(a90_of(worst) / a90_of(best), 2),
                                               title);
}

bool has_curve(const Json& design) {
  const Json& fit = design["fit"];
  return !fit.is_null() && !fit["a90"]["value"].is_null();
}

/// "The dome finds nine of ten defects from 0.109 um on, 13 times smaller than under Two panels."
std::string pod_sentence(const Json& pod) {
  std::vector<const Json*> fitted;
  for (const Json& design : pod["designs"]) {
    if (has_curve(design)) {
      fitted.push_back(&design);
    }
  }
  if (fitted.empty()) {
    return "No lighting gives a curve from which the size of a defect that is found follows.";
  }
  const auto [best, worst] =
      std::ranges::minmax_element(fitted, {}, [](const Json* design) { return a90_of(*design); });
  const std::string unit = pod["unit"];
  const double largest = largest_size(**best);
  if (a90_of(**best) > largest) {
    // Nobody draws a curve through hits alone: the lighting may find all.
    return fmt::format("No lighting{} finds nine of ten defects of any size up to {} {}.",
                       fitted.size() < pod["designs"].size() ? " with a curve" : "",
                       measured(largest),
                       unit);
  }
  return fmt::format("{} finds nine of ten defects from {} {} on{}.",
                     (**best)["title"].get<std::string>(),
                     measured(a90_of(**best)),
                     unit,
                     *best == *worst ? "" : than_text(**best, **worst, unit));
}

/// What is said of the parts, `{ code, text }` each; those of the headline first.
struct PartFindings {
  Json headline = Json::array();
  Json details = Json::array();
};

PartFindings findings_on_parts(const Json& result) {
  PartFindings findings;
  if (result.contains("sorting")) {
    findings.headline.push_back(
        {{"code", "sorted"}, {"text", sorting_sentence(result["sorting"])}});
  }
  if (result.contains("pod")) {
    const Json& pod = result["pod"];
    findings.headline.push_back({{"code", "detectable_size"}, {"text", pod_sentence(pod)}});
    for (const Json& design : pod["designs"]) {
      findings.details.push_back(
          {{"code", "detectable_size"}, {"text", pod_line(design, pod["unit"])}});
    }
  }
  return findings;
}

}  // namespace

Json with_population_verdict(const Json& verdict, const Json& result) {
  const PartFindings parts = findings_on_parts(result);
  if (parts.headline.empty()) {
    return verdict;
  }
  std::vector<std::string> sentences;
  Json findings = parts.headline;
  for (const Json& finding : parts.headline) {
    sentences.push_back(finding["text"]);
  }
  Json details = Json::array();
  for (const Json& more : {parts.details, verdict["findings"]}) {
    for (const Json& finding : more) {
      details.push_back(finding["text"]);
      findings.push_back(finding);
    }
  }
  return {{"sentence", join(sentences, " ")},
          {"tone", verdict["tone"] == "bad" ? "bad" : "neutral"},
          {"details", details},
          {"findings", findings}};
}

}  // namespace glint

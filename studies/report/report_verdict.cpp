// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_verdict.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/report/report_findings.h"
#include "studies/report/report_front.h"
#include "studies/report/report_kinds.h"
#include "studies/report/report_runs.h"
#include "studies/report/verdict_of_designs.h"
#include "studies/report/verdict_parts.h"

namespace glint {

using Json = nlohmann::ordered_json;

namespace report_detail {

const Json& member(const Json& object, const char* name) {
  static const Json none;
  const auto found = object.is_object() ? object.find(name) : object.end();
  return object.is_object() && found != object.end() ? *found : none;
}

std::string text_of(const Json& object, const char* name) {
  const Json& value = member(object, name);
  return value.is_string() ? value.get<std::string>() : std::string();
}

std::optional<double> number_of(const Json& object, const std::string& name) {
  const Json& value = member(object, name.c_str());
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    return std::nullopt;
  }
  return value.get<double>();
}

}  // namespace report_detail

namespace {

using report_detail::best_design;
using report_detail::Finding;
using report_detail::is_ahead;
using report_detail::lead_over;
using report_detail::member;
using report_detail::number_of;
using report_detail::say_limits;
using report_detail::text_of;
using report_detail::title_of;
using report_detail::Verdict;
using report_detail::Wording;

Json json_of(const Verdict& verdict) {
  Json findings = Json::array();
  std::vector<std::string> sentences;
  for (const Finding& finding : verdict.headline) {
    sentences.push_back(finding.text);
    findings.push_back({{"code", finding.code}, {"text", finding.text}});
  }
  Json details = Json::array();
  for (const Finding& finding : verdict.details) {
    details.push_back(finding.text);
    findings.push_back({{"code", finding.code}, {"text", finding.text}});
  }
  return {{"sentence", join(sentences, " ")},
          {"tone", verdict.tone},
          {"details", details},
          {"findings", findings}};
}

/// A design that another is compared with, and what it is called.
struct Rival {
  const Json* design = nullptr;  ///< has a value of the score
  std::string name;              ///< "the best prototype"
  std::string full_name;         ///< "the best prototype, dome"

  bool is_feasible() const { return member(*design, "feasible") != Json(false); }
};

/// The baseline and the best prototype, as far as there are any.
std::vector<Rival> rivals_in(const Json& designs, const Wording& wording) {
  std::vector<Rival> rivals;
  if (const Json* baseline = best_design(designs, wording, "baseline")) {
    rivals.push_back({baseline, "the baseline", "the baseline"});
  }
  if (const Json* prototype = best_design(designs, wording, "prototype")) {
    rivals.push_back(
        {prototype, "the best prototype", "the best prototype, " + title_of(*prototype)});
  }
  return rivals;
}

/// ": 2.00 better than the baseline and 1.00 worse than the best prototype, dome (which misses a
/// limit)"
std::string comparisons(const std::vector<Rival>& rivals, const Wording& wording, double value) {
  std::vector<std::string> parts;
  for (const Rival& rival : rivals) {
    parts.push_back(fmt::format("{} {}{}",
                                wording.against(value, *wording.value(*rival.design)),
                                rival.full_name,
                                rival.is_feasible() ? "" : " (which misses a limit)"));
  }
  return parts.empty() ? std::string() : ": " + join(parts, " and ");
}

std::string evaluations(std::size_t count) {
  return fmt::format("{} evaluation{}", count, count == 1 ? "" : "s");
}

std::size_t failures(const Json& trials) {
  return static_cast<std::size_t>(std::ranges::count_if(
      trials, [](const Json& trial) { return member(trial, "failed") == Json(true); }));
}

std::vector<Finding> search_details(const Json& data, const Json* winner, const Wording& wording) {
  std::vector<Finding> details;
  if (winner != nullptr && wording.searched(*winner) &&
      number_of(member(*winner, "rescored"), wording.score())) {
    details.push_back(
        {"rescored",
         fmt::format("Scored again with fresh seeds and finer sampling: {} is {}; the search "
                     "itself saw {}.",
                     wording.label(),
                     wording.text(*wording.value(*winner)),
                     wording.text(*wording.searched(*winner)))});
  }
  const std::string status = text_of(data, "status");
  const std::size_t count = member(data, "trials").size();
  if (status == "interrupted") {
    details.push_back(
        {"interrupted",
         fmt::format("The run was interrupted after {}; running it again resumes there.",
                     evaluations(count))});
  } else if (status == "budget") {
    details.push_back(
        {"budget", fmt::format("The budget ended the search after {}.", evaluations(count))});
  }
  return details;
}

/// How often each constraint was met, which tells what to loosen.
std::vector<Finding> limit_rates(const Json& data) {
  std::vector<Finding> rates;
  const Json& trials = member(data, "trials");
  for (const Json& constraint : member(data, "constraints")) {
    const Wording wording(data, text_of(constraint, "name"), true);
    const auto met = std::ranges::count_if(trials, [&](const Json& trial) {
      return report_detail::meets(constraint, wording.searched(trial));
    });
    rates.push_back({"limit_rate",
                     fmt::format("{}: within its limit in {} of {}.",
                                 wording.label(),
                                 met,
                                 evaluations(trials.size()))});
  }
  return rates;
}

void say_lead(const Rival& rival, const Json& design, const Wording& wording, Verdict& verdict) {
  const auto lead = lead_over(rival.design, design, wording);
  if (!lead) {
    return;
  }
  const std::string noise = wording.noise_text(lead->noise);
  if (lead->is_sure()) {
    verdict.say("lead_sure",
                fmt::format("The lead over {} is larger than the noise ({}).", rival.name, noise));
  } else if (lead->noise > 0.0 && -lead->lead <= lead->noise) {
    verdict.say("lead_open",
                fmt::format("The lead {} {} is not larger than the noise ({}): it may be chance; "
                            "more parts or scans would show.",
                            lead->lead < 0.0 ? "of" : "over",
                            rival.name,
                            noise));
  }
}

/// A prototype that meets the limits and is ahead of what was searched for is the better design.
bool say_better_prototype(const std::vector<Rival>& rivals,
                          const Json& winner,
                          const Wording& wording,
                          Verdict& verdict) {
  const auto better = std::ranges::find_if(rivals, [&](const Rival& rival) {
    return report_detail::role_of(*rival.design) == "prototype" && rival.is_feasible() &&
           is_ahead(winner, *rival.design, wording);
  });
  if (better == rivals.end()) {
    return false;
  }
  verdict.say("prototype_better",
              fmt::format("The search has found nothing as good as {}.", better->full_name));
  return true;
}

/// Of a search that found nothing: what the best of the designs that were set shows.
void add_findings_on_rest(const Json& data, const Wording& wording, Verdict& verdict) {
  if (const Json* rest = best_design(member(data, "designs"), wording, "")) {
    for (Finding& finding : report_detail::findings_on(data, *rest)) {
      finding.text = fmt::format("Of {}: {}", title_of(*rest), finding.text);
      verdict.details.push_back(std::move(finding));
    }
  }
}

/// A search that found no design to recommend.
Verdict verdict_without_winner(const Json& data, const Wording& wording) {
  const Json& trials = member(data, "trials");
  Verdict verdict{.tone = "bad", .details = search_details(data, nullptr, wording)};
  if (failures(trials) == trials.size()) {
    verdict.say(
        "all_failed",
        trials.size() == 1
            ? std::string("The only evaluation failed; its reason is below.")
            : fmt::format("All {} evaluations failed; the reasons are below.", trials.size()));
    add_findings_on_rest(data, wording, verdict);
    return verdict;
  }
  verdict.say("no_feasible", fmt::format("No feasible design in {}.", evaluations(trials.size())));
  verdict.add(limit_rates(data));
  add_findings_on_rest(data, wording, verdict);
  return verdict;
}

/// The closest design of a search in which none meets every limit.
Verdict verdict_of_closest(const Json& data, const Json& closest, const Wording& wording) {
  Verdict verdict{.tone = "bad"};
  const double value = *wording.value(closest);
  verdict.say(
      "no_feasible",
      fmt::format("{} reaches {} {}{}.",
                  member(closest, "limits").is_object()
                      ? "No design is expected to meet every constraint. The most likely one"
                      : "No design meets every constraint. The closest one",
                  wording.label(),
                  wording.text(value),
                  comparisons(rivals_in(member(data, "designs"), wording), wording, value)));
  say_limits(data, closest, verdict);
  verdict.add(report_detail::findings_on(data, closest));
  verdict.add(search_details(data, &closest, wording));
  verdict.add(limit_rates(data));
  return verdict;
}

const Json* baseline_of(const std::vector<Rival>& rivals) {
  const auto found = std::ranges::find_if(rivals, [](const Rival& rival) {
    return report_detail::role_of(*rival.design) == "baseline";
  });
  return found == rivals.end() ? nullptr : found->design;
}

/// Of the first sentence: the outcome against the baseline.
const char* code_of_search(const std::vector<Rival>& rivals, const Wording& wording, double value) {
  const Json* baseline = baseline_of(rivals);
  if (baseline == nullptr) {
    return "winner_alone";
  }
  const double there = *wording.value(*baseline);
  return wording.is_level(value, there)    ? "winner_level"
         : wording.is_better(value, there) ? "winner_better"
                                           : "winner_worse";
}

Verdict verdict_of_search(const Json& data, const Json& winner, const Wording& wording) {
  if (member(winner, "feasible") == Json(false)) {
    return verdict_of_closest(data, winner, wording);
  }
  Verdict verdict;
  const double value = *wording.value(winner);
  const std::vector<Rival> rivals = rivals_in(member(data, "designs"), wording);
  verdict.say(code_of_search(rivals, wording, value),
              fmt::format("The winner reaches {} {}{}.",
                          wording.label(),
                          wording.text(value),
                          comparisons(rivals, wording, value)));
  for (const Rival& rival : rivals) {
    say_lead(rival, winner, wording, verdict);
  }
  const bool is_beaten = say_better_prototype(rivals, winner, wording, verdict);
  say_limits(data, winner, verdict);
  verdict.add(report_detail::findings_on(data, winner));
  verdict.add(report_detail::findings_on_kinds(data));
  verdict.add(search_details(data, &winner, wording));
  const Json* baseline = baseline_of(rivals);
  verdict.judge(!is_beaten && (baseline == nullptr || is_ahead(*baseline, winner, wording)));
  return verdict;
}

/// "8.1 (baseline 3.2)"
std::string value_beside(const Json* baseline, const Json& design, const Wording& wording) {
  const auto value = wording.value(design);
  const auto there = baseline == nullptr ? std::nullopt : wording.value(*baseline);
  return (value ? wording.text(*value) : std::string("unknown")) +
         (there ? fmt::format(" (baseline {})", wording.text(*there)) : std::string());
}

std::vector<Wording> objectives_of(const Json& data) {
  std::vector<Wording> objectives;
  for (const Json& objective : member(member(data, "front"), "objectives")) {
    objectives.emplace_back(
        data, text_of(objective, "score"), text_of(objective, "direction") == "maximise");
  }
  return objectives;
}

/// What a compromise reaches in each objective.
std::vector<std::string> reached_by(const Json& data, const Json& winner, const Json* baseline) {
  std::vector<std::string> texts;
  for (const Wording& wording : objectives_of(data)) {
    texts.push_back(wording.label() + " " + value_beside(baseline, winner, wording));
  }
  return texts;
}

/// Whether a design is better than another in some objective by more than noise, and in none worse.
bool gains_on(const Json& data, const Json& other, const Json& design) {
  bool is_gain = false;
  for (const Wording& wording : objectives_of(data)) {
    const auto value = wording.value(design);
    const auto there = wording.value(other);
    if (!value || (there && wording.is_better(*there, *value))) {
      return false;
    }
    is_gain = is_gain || (there && is_ahead(other, design, wording));
  }
  return is_gain;
}

/// A prototype that meets the limits and gains on the compromise is the better design.
bool say_prototype_that_gains(const Json& data, const Json& winner, Verdict& verdict) {
  for (const Json& design : member(data, "designs")) {
    if (report_detail::role_of(design) == "prototype" &&
        member(design, "feasible") != Json(false) && gains_on(data, winner, design)) {
      verdict.say("prototype_better",
                  fmt::format("The prototype {} is better in some objective and worse in none.",
                              title_of(design)));
      return true;
    }
  }
  return false;
}

/// The compromise of several objectives: where it is in each, and why it was taken.
Verdict verdict_of_compromise(const Json& data, const Json& winner, const Wording& first) {
  const Json& front = member(data, "front");
  const Json& designs = member(data, "designs");
  if (member(winner, "feasible") == Json(false) || member(front, "designs").empty()) {
    return verdict_of_closest(data, winner, first);
  }
  const auto own = std::ranges::find_if(
      designs, [](const Json& design) { return report_detail::role_of(design) == "baseline"; });
  const Json* baseline = own == designs.end() ? nullptr : &*own;
  Verdict verdict;
  verdict.say("compromise",
              fmt::format("The compromise reaches {}: {}.",
                          join(reached_by(data, winner, baseline), ", "),
                          text_of(member(front, "chosen"), "reason")));
  const bool is_beaten = say_prototype_that_gains(data, winner, verdict);
  say_limits(data, winner, verdict);
  verdict.add(report_detail::findings_on_front(data));
  verdict.add(report_detail::findings_on(data, winner));
  verdict.add(report_detail::findings_on_kinds(data));
  verdict.add(search_details(data, &winner, first));
  verdict.judge(!is_beaten && (baseline == nullptr || gains_on(data, *baseline, winner)));
  return verdict;
}

}  // namespace

nlohmann::ordered_json report_verdict(const nlohmann::ordered_json& data) {
  const Wording wording(data);
  if (!member(data, "runs").empty()) {
    return json_of(report_detail::verdict_of_runs(data));
  }
  if (const Json* winner = best_design(member(data, "designs"), wording, "winner")) {
    return json_of(member(data, "front").is_object() ? verdict_of_compromise(data, *winner, wording)
                                                     : verdict_of_search(data, *winner, wording));
  }
  return json_of(member(data, "trials").empty() ? report_detail::verdict_of_designs(data, wording)
                                                : verdict_without_winner(data, wording));
}

}  // namespace glint

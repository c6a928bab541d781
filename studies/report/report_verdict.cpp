// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_verdict.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/report/report_findings.h"
#include "studies/report/report_front.h"
#include "studies/report/report_ranking.h"
#include "studies/report/report_runs.h"
#include "studies/report/report_wording.h"

namespace glint {

using Json = nlohmann::ordered_json;

namespace report_detail {

const Json& member(const Json& object, const char* name) {
  static const Json kNone;
  const auto found = object.is_object() ? object.find(name) : object.end();
  return object.is_object() && found != object.end() ? *found : kNone;
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
using report_detail::member;
using report_detail::number_of;
using report_detail::text_of;
using report_detail::title_of;
using report_detail::Wording;

/// A verdict in the making.
struct Verdict {
  const char* tone = "neutral";
  std::vector<Finding> headline = {};
  std::vector<Finding> details = {};

  void say(const char* code, const std::string& text) { headline.push_back({code, text}); }

  void add(std::vector<Finding> more) { std::ranges::move(more, std::back_inserter(details)); }

  bool has(std::string_view code) const {
    return std::ranges::find(details, code, &Finding::code) != details.end();
  }
};

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

std::string comparisons(const Json& designs, const Wording& wording, double value) {
  std::vector<std::string> parts;
  if (const Json* baseline = best_design(designs, wording, "baseline")) {
    parts.push_back(wording.against(value, *wording.value(*baseline)) + " the baseline");
  }
  if (const Json* prototype = best_design(designs, wording, "prototype")) {
    parts.push_back(fmt::format("{} the best prototype, {}",
                                wording.against(value, *wording.value(*prototype)),
                                title_of(*prototype)));
  }
  return parts.empty() ? std::string() : ": " + join(parts, " and ");
}

/// Whether a design meets the limits, and which it does not.
void say_limits(const Json& data, const Json& design, Verdict& verdict) {
  const std::size_t count = member(data, "constraints").size();
  const Json& feasible = member(design, "feasible");
  if (count == 0 || !feasible.is_boolean()) {
    return;
  }
  if (feasible.get<bool>()) {
    verdict.say("limits_met",
                count == 1   ? "It meets the constraint."
                : count == 2 ? "It meets both constraints."
                             : fmt::format("It meets all {} constraints.", count));
    return;
  }
  const std::vector<std::string> missed = report_detail::missed_limits(data, design);
  if (missed.empty()) {
    verdict.say("limit_failed", "It does not meet every constraint.");
  }
  for (const std::string& text : missed) {
    verdict.say("limit_failed", fmt::format("It misses a limit: {}.", text));
  }
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

/// The lead of one design over another beside the noise of both.
struct Lead {
  double lead = 0.0;   ///< negative: it is behind
  double noise = 0.0;  ///< half the interval of the difference

  bool is_sure() const { return lead > noise; }
};

/// Empty where a score has no interval.
std::optional<Lead> lead_over(const Json* other, const Json& design, const Wording& wording) {
  const auto noise = other == nullptr ? std::nullopt : wording.noise(design, *other);
  if (!noise) {
    return std::nullopt;
  }
  const double value = *wording.value(design);
  const double other_value = *wording.value(*other);
  const double gap = std::abs(value - other_value);
  return Lead{.lead = wording.is_better(value, other_value) ? gap : -gap, .noise = *noise};
}

void say_lead(const Lead& lead, const Wording& wording, Verdict& verdict) {
  const std::string noise = wording.noise_text(lead.noise);
  if (lead.is_sure()) {
    verdict.say("lead_sure",
                fmt::format("The lead over the baseline is larger than the noise ({}).", noise));
  } else if (lead.lead > 0.0 || (lead.lead == 0.0 && lead.noise > 0.0)) {
    verdict.say("lead_open",
                fmt::format("The lead over the baseline is not larger than the noise ({}): it may "
                            "be chance; more parts or scans would show.",
                            noise));
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
    return verdict;
  }
  verdict.say("no_feasible", fmt::format("No feasible design in {}.", evaluations(trials.size())));
  verdict.add(limit_rates(data));
  return verdict;
}

/// The closest design of a search in which none meets every limit.
Verdict verdict_of_closest(const Json& data, const Json& closest, const Wording& wording) {
  Verdict verdict{.tone = "bad"};
  const double value = *wording.value(closest);
  verdict.say("no_feasible",
              fmt::format("No design meets every constraint. The closest one reaches {} {}{}.",
                          wording.label(),
                          wording.text(value),
                          comparisons(member(data, "designs"), wording, value)));
  say_limits(data, closest, verdict);
  verdict.add(report_detail::findings_on(data, closest));
  verdict.add(search_details(data, &closest, wording));
  verdict.add(limit_rates(data));
  return verdict;
}

Verdict verdict_of_search(const Json& data, const Json& winner, const Wording& wording) {
  if (member(winner, "feasible") == Json(false)) {
    return verdict_of_closest(data, winner, wording);
  }
  Verdict verdict;
  const Json& designs = member(data, "designs");
  const double value = *wording.value(winner);
  const Json* baseline = best_design(designs, wording, "baseline");
  const double there = baseline == nullptr ? value : *wording.value(*baseline);
  verdict.say(baseline == nullptr               ? "winner_alone"
              : wording.is_level(value, there)  ? "winner_level"
              : wording.is_better(value, there) ? "winner_better"
                                                : "winner_worse",
              fmt::format("The winner reaches {} {}{}.",
                          wording.label(),
                          wording.text(value),
                          comparisons(designs, wording, value)));
  const auto lead = lead_over(baseline, winner, wording);
  if (lead) {
    say_lead(*lead, wording, verdict);
  }
  say_limits(data, winner, verdict);
  verdict.add(report_detail::findings_on(data, winner));
  verdict.add(search_details(data, &winner, wording));
  const bool is_gain =
      lead ? lead->is_sure() : baseline == nullptr || wording.is_better(value, there);
  const bool is_doubtful = verdict.has("defects_fainter") || verdict.has("defects_hidden") ||
                           verdict.has("objective_flat") || verdict.has("limit_lost");
  verdict.tone = is_gain && !is_doubtful ? "good" : "neutral";
  return verdict;
}

/// "8.1 (baseline 3.2)"
std::string value_beside(const Json* baseline, const Json& design, const Wording& wording) {
  const auto value = wording.value(design);
  const auto there = baseline == nullptr ? std::nullopt : wording.value(*baseline);
  return (value ? wording.text(*value) : std::string("unknown")) +
         (there ? fmt::format(" (baseline {})", wording.text(*there)) : std::string());
}

/// The compromise of several objectives: where it is in each, and why it was taken.
Verdict verdict_of_compromise(const Json& data, const Json& winner, const Wording& first) {
  const Json& front = member(data, "front");
  const Json& designs = member(data, "designs");
  if (member(winner, "feasible") == Json(false) || member(front, "designs").empty()) {
    return verdict_of_closest(data, winner, first);
  }
  const auto own = std::ranges::find_if(
      designs, [](const Json& design) { return text_of(design, "role") == "baseline"; });
  const Json* baseline = own == designs.end() ? nullptr : &*own;
  std::vector<std::string> reached;
  bool is_worse_in_some = false;
  for (const Json& objective : member(front, "objectives")) {
    const Wording wording(
        data, text_of(objective, "score"), text_of(objective, "direction") == "maximise");
    reached.push_back(wording.label() + " " + value_beside(baseline, winner, wording));
    const auto value = wording.value(winner);
    const auto there = baseline == nullptr ? std::nullopt : wording.value(*baseline);
    is_worse_in_some = is_worse_in_some || (value && there && wording.is_better(*there, *value));
  }
  const Json& chosen = member(front, "chosen");
  Verdict verdict{.tone = is_worse_in_some ? "neutral" : "good"};
  verdict.say(
      "compromise",
      fmt::format(
          "The compromise reaches {}: {}.", join(reached, ", "), text_of(chosen, "reason")));
  say_limits(data, winner, verdict);
  verdict.add(report_detail::findings_on_front(data));
  if (verdict.has("compromise_dominated")) {
    verdict.tone = "neutral";
  }
  verdict.add(report_detail::findings_on(data, winner));
  verdict.add(search_details(data, &winner, first));
  return verdict;
}

/// "12.3 (11.8 to 12.9)"
std::string ranked_value(const Json& row, const Wording& wording) {
  const std::string value = wording.text(*number_of(row, "value"));
  const auto low = number_of(row, "low");
  return low ? fmt::format("{} ({} to {})",
                           value,
                           wording.text(*low),
                           wording.text(*number_of(row, "high")))
             : value;
}

/// How sure the first place of a ranking is.
void add_certainty(const Json& ranking, const Wording& wording, Verdict& verdict) {
  constexpr double kSure = 0.95;
  const auto probability = number_of(ranking.front(), "probability_best");
  if (!probability || ranking.size() < 2) {
    return;
  }
  const double gap = std::abs(*number_of(ranking[0], "value") - *number_of(ranking[1], "value"));
  const std::string text = fmt::format(
      "The next, {}, is {} behind. With other noise {} would be the best {:.0f} times of 100.",
      title_of(ranking[1]),
      wording.size(gap),
      title_of(ranking[0]),
      100.0 * *probability);
  if (*probability >= kSure) {
    verdict.details.push_back({"ranking_sure", text});
    verdict.tone = "good";
  } else {
    verdict.details.push_back({"ranking_open", text + " The order may be chance."});
  }
}

/// What the designs of a ranking from this one on miss.
void add_missed(const Json& ranking, std::size_t first, Verdict& verdict) {
  for (std::size_t i = first; i < ranking.size(); ++i) {
    for (const Json& text : ranking[i]["missed"]) {
      verdict.details.push_back(
          {"limit_failed",
           fmt::format("{} misses a limit: {}.", title_of(ranking[i]), text.get<std::string>())});
    }
  }
}

/// The best of a ranking, and what the others miss.
void say_ranking(const Json& data,
                 const Json& ranking,
                 const Json& best,
                 const Wording& wording,
                 Verdict& verdict) {
  const Json& first = ranking.front();
  const bool is_flat = ranking.size() > 1 && std::ranges::all_of(ranking, [&](const Json& row) {
                         return number_of(row, "value") == number_of(first, "value");
                       });
  if (is_flat) {
    verdict.say("objective_flat",
                fmt::format("All {} designs have the same {}, {}: it does not tell them apart.",
                            ranking.size(),
                            wording.label(),
                            wording.text(*number_of(first, "value"))));
    add_missed(ranking, 0, verdict);
    return;
  }
  verdict.say("ranked",
              fmt::format("Of {} designs, {} has the best {}: {}.",
                          member(data, "designs").size(),
                          title_of(first),
                          wording.label(),
                          ranked_value(first, wording)));
  say_limits(data, best, verdict);
  add_certainty(ranking, wording, verdict);
  add_missed(ranking, 1, verdict);
}

/// Designs of which none was searched for.
Verdict verdict_of_ranking(const Json& data, const Wording& wording) {
  Verdict verdict;
  const Json ranking = report_detail::ranking_of(data);
  const auto& designs = member(data, "designs");
  const Json* best = &*std::ranges::find_if(designs, [&](const Json& design) {
    return text_of(design, "key") == text_of(ranking.front(), "key");
  });
  say_ranking(data, ranking, *best, wording, verdict);
  verdict.add(report_detail::findings_on(data, *best));
  if (verdict.has("defects_hidden") || member(*best, "feasible") == Json(false)) {
    verdict.tone = "neutral";
  }
  return verdict;
}

/// A render, or designs beside each other without a search.
Verdict verdict_of_designs(const Json& data, const Wording& wording) {
  const Json& designs = member(data, "designs");
  const Json* best = best_design(designs, wording, "");
  Verdict verdict;
  if (best == nullptr) {
    designs.empty() ? verdict.say("nothing_yet", "There is no result yet.")
                    : verdict.say("rendered", "The scene was rendered; no objective is set.");
    return verdict;
  }
  if (designs.size() > 1) {
    return verdict_of_ranking(data, wording);
  }
  verdict.say(
      "one_design",
      fmt::format(
          "The design reaches {} {}.", wording.label(), wording.text(*wording.value(*best))));
  say_limits(data, *best, verdict);
  verdict.add(report_detail::findings_on(data, *best));
  return verdict;
}

}  // namespace

nlohmann::ordered_json report_verdict(const nlohmann::ordered_json& data) {
  const Wording wording(data);
  if (!member(data, "runs").empty()) {
    report_detail::RunsVerdict runs = report_detail::verdict_of_runs(data);
    return json_of(
        {.tone = runs.tone, .headline = {runs.headline}, .details = std::move(runs.details)});
  }
  if (const Json* winner = best_design(member(data, "designs"), wording, "winner")) {
    return json_of(member(data, "front").is_object() ? verdict_of_compromise(data, *winner, wording)
                                                     : verdict_of_search(data, *winner, wording));
  }
  return json_of(member(data, "trials").empty() ? verdict_of_designs(data, wording)
                                                : verdict_without_winner(data, wording));
}

}  // namespace glint

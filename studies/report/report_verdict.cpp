// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_verdict.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "metrics/scores.h"

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

using report_detail::member;
using report_detail::number_of;
using report_detail::text_of;

constexpr double kLevelPoints = 0.05;  // differences that would print as 0.0 points

/// Words about one objective: how a value and a difference of it are written, and what is better.
class Wording {
 public:
  explicit Wording(const Json& data)
      : score_(text_of(member(data, "objective"), "name")),
        maximise_(!text_of(member(data, "objective"), "sense").starts_with("min")) {
    const Json& info = member(member(data, "score_info"), score_.c_str());
    label_ = text_of(info, "label").empty() ? score_ : text_of(info, "label");
    is_percent_ = text_of(info, "format") == "percent";
  }

  /// Fresh seeds first: the search's own number is the best of many and so a little too good.
  std::optional<double> value(const Json& design) const {
    const auto fresh = number_of(member(design, "rescored"), score_);
    return fresh ? fresh : searched(design);
  }

  /// Half the width of the interval of that value; empty: it has none.
  std::optional<double> noise(const Json& design) const {
    const bool is_fresh = number_of(member(design, "rescored"), score_).has_value();
    const Json& scores = member(design, is_fresh ? "rescored" : "scores");
    const std::string whole(without_bound(score_));
    const auto low = number_of(scores, whole + ".low");
    const auto high = number_of(scores, whole + ".high");
    const auto error = number_of(scores, error_name(whole));
    if (!error && !(low && high)) {
      return std::nullopt;
    }
    return std::hypot(low && high ? 0.5 * (*high - *low) : 0.0, 2.0 * error.value_or(0.0));
  }

  std::optional<double> searched(const Json& design) const {
    return number_of(member(design, "scores"), score_);
  }

  bool is_better(double a, double b) const { return maximise_ ? a > b : a < b; }

  const std::string& label() const { return label_; }

  std::string text(double value) const {
    return is_percent_ ? fmt::format("{:.1f} %", 100 * value) : fmt::format("{:.4g}", value);
  }

  /// A difference: "6.4 points", "0.12".
  std::string size(double gap) const {
    return is_percent_ ? fmt::format("{:.1f} points", 100 * gap) : fmt::format("{:.3g}", gap);
  }

  /// "6.4 points better than", "level with".
  std::string against(double value, double other) const {
    const double gap = std::abs(value - other);
    const double scale = std::max(std::abs(value), std::abs(other));
    if (is_percent_ ? 100 * gap < kLevelPoints : gap <= 1e-4 * scale) {
      return "level with";
    }
    return size(gap) + (is_better(value, other) ? " better than" : " worse than");
  }

 private:
  std::string score_;
  std::string label_;
  bool maximise_;
  bool is_percent_ = false;
};

std::string role_of(const Json& design) {
  const std::string role = text_of(design, "role");
  const std::string key = text_of(design, "key");
  if (!role.empty()) {
    return role;
  }
  return key == "winner" || key == "baseline" ? key : "prototype";
}

std::string title_of(const Json& design) {
  const std::string title = text_of(design, "title");
  return title.empty() ? text_of(design, "key") : title;
}

/// The best of the designs with that role ("" = any) that has a value, feasible ones first; nullptr
/// when there is none.
const Json* best_design(const Json& designs, const Wording& wording, std::string_view role) {
  const Json* best = nullptr;
  for (const Json& design : designs) {
    const auto value = wording.value(design);
    if (!value || (!role.empty() && role_of(design) != role)) {
      continue;
    }
    const bool is_feasible = member(design, "feasible") != Json(false);
    const bool best_is_feasible = best != nullptr && member(*best, "feasible") != Json(false);
    if (best == nullptr || (is_feasible && !best_is_feasible) ||
        (is_feasible == best_is_feasible && wording.is_better(*value, *wording.value(*best)))) {
      best = &design;
    }
  }
  return best;
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

std::string constraint_sentence(const Json& data, const Json& design) {
  const std::size_t count = member(data, "constraints").size();
  const Json& feasible = member(design, "feasible");
  if (count == 0 || !feasible.is_boolean()) {
    return {};
  }
  if (!feasible.get<bool>()) {
    return " It does not meet every constraint.";
  }
  return count == 1   ? " It meets the constraint."
         : count == 2 ? " It meets both constraints."
                      : fmt::format(" It meets all {} constraints.", count);
}

Json make_verdict(const std::string& sentence, const char* tone, std::vector<std::string> details) {
  return {{"sentence", sentence}, {"tone", tone}, {"details", std::move(details)}};
}

std::string evaluations(std::size_t count) {
  return fmt::format("{} evaluation{}", count, count == 1 ? "" : "s");
}

std::size_t failures(const Json& trials) {
  return static_cast<std::size_t>(std::ranges::count_if(
      trials, [](const Json& trial) { return member(trial, "failed") == Json(true); }));
}

std::vector<std::string> search_details(const Json& data,
                                        const Json* winner,
                                        const Wording& wording) {
  std::vector<std::string> details;
  if (winner != nullptr && !member(*winner, "rescored").empty() && wording.searched(*winner) &&
      number_of(member(*winner, "rescored"), text_of(member(data, "objective"), "name"))) {
    details.push_back(fmt::format(
        "Scored again with fresh seeds and finer sampling: {} is {}; the search itself saw {}.",
        wording.label(),
        wording.text(*wording.value(*winner)),
        wording.text(*wording.searched(*winner))));
  }
  const std::string status = text_of(data, "status");
  const std::size_t count = member(data, "trials").size();
  if (status == "interrupted") {
    details.push_back(fmt::format(
        "The run was interrupted after {}; running it again resumes there.", evaluations(count)));
  } else if (status == "budget") {
    details.push_back(fmt::format("The budget ended the search after {}.", evaluations(count)));
  }
  return details;
}

/// How often each constraint was met, which tells what to loosen.
std::vector<std::string> constraint_details(const Json& data) {
  std::vector<std::string> details;
  const Json& trials = member(data, "trials");
  for (const Json& constraint : member(data, "constraints")) {
    const std::string name = text_of(constraint, "name");
    const auto low = number_of(constraint, "min");
    const auto high = number_of(constraint, "max");
    const auto met = std::ranges::count_if(trials, [&](const Json& trial) {
      const auto value = number_of(member(trial, "scores"), name);
      return value && (!low || *value >= *low) && (!high || *value <= *high);
    });
    const std::string label = text_of(member(member(data, "score_info"), name.c_str()), "label");
    details.push_back(
        fmt::format("{}: within its limit in {} of {}.", label, met, evaluations(trials.size())));
  }
  return details;
}

/// The lead of one design over another beside the noise of both.
struct Lead {
  double lead = 0.0;   ///< negative: it is behind
  double noise = 0.0;  ///< half the interval of the difference, as if their noise were independent

  bool is_sure() const { return lead > noise; }
};

/// Empty where a score has no interval.
std::optional<Lead> lead_over(const Json* other, const Json& design, const Wording& wording) {
  const auto noise = wording.noise(design);
  const auto other_noise = other == nullptr ? std::nullopt : wording.noise(*other);
  if (!noise || !other_noise) {
    return std::nullopt;
  }
  const double value = *wording.value(design);
  const double other_value = *wording.value(*other);
  const double gap = std::abs(value - other_value);
  return Lead{.lead = wording.is_better(value, other_value) ? gap : -gap,
              .noise = std::hypot(*noise, *other_noise)};
}

std::string lead_sentence(const Lead& lead, const Wording& wording) {
  const std::string noise = wording.size(lead.noise);
  if (lead.is_sure()) {
    return fmt::format(" The lead over the baseline is larger than the noise ({}).", noise);
  }
  return lead.lead >= 0.0
             ? fmt::format(
                   " The lead over the baseline is not larger than the noise ({}): it may be "
                   "chance; more parts or scans would show.",
                   noise)
             : "";
}

/// A search that found no design to recommend.
Json verdict_without_winner(const Json& data, const Wording& wording) {
  const Json& trials = member(data, "trials");
  if (failures(trials) == trials.size()) {
    const std::string sentence =
        trials.size() == 1
            ? std::string("The only evaluation failed; its reason is below.")
            : fmt::format("All {} evaluations failed; the reasons are below.", trials.size());
    return make_verdict(sentence, "bad", search_details(data, nullptr, wording));
  }
  std::vector<std::string> details = search_details(data, nullptr, wording);
  for (std::string& line : constraint_details(data)) {
    details.push_back(std::move(line));
  }
  return make_verdict(
      fmt::format("No feasible design in {}.", evaluations(trials.size())), "bad", details);
}

Json verdict_of_search(const Json& data, const Json& winner, const Wording& wording) {
  const Json& designs = member(data, "designs");
  const double value = *wording.value(winner);
  const bool is_infeasible = member(winner, "feasible") == Json(false);
  const std::string reached = fmt::format("reaches {} {}", wording.label(), wording.text(value));
  const std::string against = comparisons(designs, wording, value);
  if (is_infeasible) {
    return make_verdict(
        fmt::format("No design meets every constraint. The closest one {}{}.", reached, against),
        "bad",
        search_details(data, &winner, wording));
  }
  const Json* baseline = best_design(designs, wording, "baseline");
  const auto lead = lead_over(baseline, winner, wording);
  const bool is_gain =
      lead ? lead->is_sure()
           : baseline == nullptr || wording.is_better(value, *wording.value(*baseline));
  return make_verdict(fmt::format("The winner {}{}.{}{}",
                                  reached,
                                  against,
                                  lead ? lead_sentence(*lead, wording) : "",
                                  constraint_sentence(data, winner)),
                      is_gain ? "good" : "neutral",
                      search_details(data, &winner, wording));
}

/// A render or a check: designs without a search.
Json verdict_of_designs(const Json& data, const Wording& wording) {
  const Json& designs = member(data, "designs");
  const Json* best = best_design(designs, wording, "");
  if (best == nullptr) {
    return make_verdict(designs.empty() ? "There is no result yet."
                                        : "The scene was rendered; no objective is set.",
                        "neutral",
                        {});
  }
  const std::string value = wording.text(*wording.value(*best));
  if (designs.size() == 1) {
    return make_verdict(fmt::format("The design reaches {} {}.{}",
                                    wording.label(),
                                    value,
                                    constraint_sentence(data, *best)),
                        "neutral",
                        {});
  }
  return make_verdict(fmt::format("Of {} designs, {} has the best {}: {}.{}",
                                  designs.size(),
                                  title_of(*best),
                                  wording.label(),
                                  value,
                                  constraint_sentence(data, *best)),
                      "neutral",
                      {"No search was run."});
}

Json verdict_of_runs(const Json& data, const Wording& wording) {
  const Json& runs = member(data, "runs");
  const Json* best = nullptr;
  const Json* second = nullptr;
  for (const Json& run : runs) {
    const auto value = wording.value(run);
    if (!value || member(run, "feasible") == Json(false)) {
      continue;
    }
    if (best == nullptr || wording.is_better(*value, *wording.value(*best))) {
      second = std::exchange(best, &run);
    } else if (second == nullptr || wording.is_better(*value, *wording.value(*second))) {
      second = &run;
    }
  }
  if (best == nullptr) {
    return make_verdict(
        fmt::format("None of the {} runs has a feasible design.", runs.size()), "bad", {});
  }
  const double value = *wording.value(*best);
  const std::string gap =
      second == nullptr
          ? std::string()
          : fmt::format(
                ", {} {}", wording.against(value, *wording.value(*second)), title_of(*second));
  return make_verdict(fmt::format("Of {} runs, {} has the best {}: {}{}.",
                                  runs.size(),
                                  title_of(*best),
                                  wording.label(),
                                  wording.text(value),
                                  gap),
                      "good",
                      {});
}

}  // namespace

nlohmann::ordered_json report_verdict(const nlohmann::ordered_json& data) {
  const Wording wording(data);
  if (!member(data, "runs").empty()) {
    return verdict_of_runs(data, wording);
  }
  if (const Json* winner = best_design(member(data, "designs"), wording, "winner")) {
    return verdict_of_search(data, *winner, wording);
  }
  return member(data, "trials").empty() ? verdict_of_designs(data, wording)
                                        : verdict_without_winner(data, wording);
}

}  // namespace glint

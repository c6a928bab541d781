// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"
#include "metrics/scores.h"
#include "studies/report/report_verdict.h"
#include "studies/report/variable_limits.h"

namespace glint::report_detail {
namespace {

using Json = nlohmann::ordered_json;

/// Below them a defect is not told from its background: Rose's criterion asks a signal for three to
/// five times the noise.
/// By the last part of a score's name: that of all defects, of a group, of one.
constexpr std::array kVisible = {std::pair<std::string_view, double>{"min_cnr", 3.0},
                                 std::pair<std::string_view, double>{"min_dprime", 5.0}};

constexpr double kSmallestWidth_px = 3.0;

constexpr double kNotableShare = 0.005;

bool is_about_defects(std::string_view score) {
  constexpr std::array<std::string_view, 3> kCounts = {
      "defects.made", "defects.mean_depth_um", "defects.removed_volume_mm3"};
  constexpr std::array<std::string_view, 5> kOfFlawless = {"inspection.false_alarms",
                                                           "inspection.threshold",
                                                           "inspection.region_share",
                                                           "inspection.rendering_share",
                                                           "inspection.rendering_error"};
  return (score.starts_with("defects.") && std::ranges::find(kCounts, score) == kCounts.end()) ||
         (score.starts_with("inspection.") &&
          std::ranges::find(kOfFlawless, score) == kOfFlawless.end());
}

/// How much better a value is than another; 0: not more than noise.
int compared(const Wording& wording, const Json& design, const Json& other) {
  const double value = *wording.value(design);
  const double there = *wording.value(other);
  const auto noise = wording.noise(design, other);
  if (wording.is_level(value, there) || (noise && std::abs(value - there) <= *noise)) {
    return 0;
  }
  return wording.is_better(value, there) ? 1 : -1;
}

std::string clearness(int sign) {
  return sign > 0 ? "more clearly than" : sign < 0 ? "less clearly than" : "as clearly as";
}

/// "less clearly than under the baseline (smallest CNR 3.1 against 5, noise 0.4)"
std::string comparison(const Wording& wording,
                       const Json& design,
                       const Json& other,
                       const std::string& name,
                       int sign) {
  const auto noise = wording.noise(design, other);
  return fmt::format("{} under {} ({} {} against {}{})",
                     clearness(sign),
                     name,
                     wording.label(),
                     wording.text(*wording.value(design)),
                     wording.text(*wording.value(other)),
                     noise ? ", noise " + wording.noise_text(*noise) : "");
}

void add_defects(const Json& data, const Json& design, std::vector<Finding>& findings) {
  const Wording wording = defect_wording(data);
  if (!wording.value(design)) {
    if (number_of(member(design, "scores"), "defects.made").value_or(0.0) == 0.0) {
      findings.push_back(
          {"no_defects", "The scene has no defect: nothing here says whether one would show."});
    }
    return;
  }
  const Json& designs = member(data, "designs");
  const bool is_baseline = role_of(design) == "baseline";
  const Json* baseline = is_baseline ? nullptr : best_design(designs, wording, "baseline");
  const Json* prototype = best_design(designs, Wording(data), "prototype");
  std::vector<std::string> parts;
  std::string code = "defects_shown";
  if (baseline != nullptr) {
    const int sign = compared(wording, design, *baseline);
    code = sign > 0 ? "defects_clearer" : sign < 0 ? "defects_fainter" : "defects_level";
    parts.push_back(comparison(wording, design, *baseline, "the baseline", sign));
  }
  if (prototype != nullptr && prototype != &design && wording.value(*prototype)) {
    parts.push_back(comparison(wording,
                               design,
                               *prototype,
                               "the best prototype, " + title_of(*prototype),
                               compared(wording, design, *prototype)));
  }
  findings.push_back(
      {code,
       parts.empty()
           ? fmt::format(
                 "The worst defect: {} {}.", wording.label(), wording.text(*wording.value(design)))
           : fmt::format("The worst defect shows {}.", join(parts, ", "))});
}

/// The best value of the defects' score that any design or evaluation has.
double best_value(const Json& data, const Wording& wording, double value) {
  double best = value;
  for (const char* list : {"designs", "trials"}) {
    for (const Json& entry : member(data, list)) {
      const auto other = wording.searched(entry);
      best = other && wording.is_better(*other, best) ? *other : best;
    }
  }
  return best;
}

/// The least value of a score at which a defect is told from its background; empty: not known.
std::optional<double> min_visible(const std::string& score) {
  const std::string kind = score.substr(score.rfind('.') + 1);
  const auto* row = std::ranges::find_if(
      kVisible, [&](const auto& one) { return kind == one.first || "min_" + kind == one.first; });
  const bool is_known = row != kVisible.end() && score.starts_with("defects.");
  return is_known ? std::optional(row->second) : std::nullopt;
}

void add_hidden_defects(const Json& data, const Json& design, std::vector<Finding>& findings) {
  const Wording wording = defect_wording(data);
  const auto least = min_visible(wording.score());
  const auto value = wording.value(design);
  if (!least || !value || *value >= *least) {
    return;
  }
  const double best = best_value(data, wording, *value);
  findings.push_back(
      {"defects_hidden",
       best < *least
           ? fmt::format("No design here shows the worst defect: {} is {} at most, and below {:g} "
                         "it is not told from its background. Other lighting, another place or a "
                         "larger defect is needed.",
                         wording.label(),
                         wording.text(best, wording.digits_apart(best, *least)),
                         *least)
           : fmt::format("The worst defect hardly shows: {} is below {:g}; another design reached "
                         "{}.",
                         wording.label(),
                         *least,
                         wording.text(best))});
}

void add_narrow_defects(const Json& design, std::vector<Finding>& findings) {
  std::vector<std::string> narrow;
  for (const Json& defect : member(design, "defects")) {
    const auto width_px = number_of(defect, "width_px");
    if (width_px && *width_px < kSmallestWidth_px) {
      narrow.push_back(fmt::format("{} {:.2g} px", text_of(defect, "label"), *width_px));
    }
  }
  if (!narrow.empty()) {
    constexpr std::size_t kNamed = 4;
    const std::size_t more = narrow.size() > kNamed ? narrow.size() - kNamed : 0;
    narrow.resize(std::min(narrow.size(), kNamed));
    findings.push_back(
        {"narrow_defect",
         fmt::format(
             "Narrower than three pixels: {}{}. Scores of such a defect depend on where the "
             "pixels happen to lie; take smaller pixels.",
             join(narrow, ", "),
             more > 0 ? fmt::format(" and {} more", more) : "")});
  }
}

void add_dark_part(const Json& data, const Json& design, std::vector<Finding>& findings) {
  const auto share_of = [&](const char* score) { return Wording(data, score, true).value(design); };
  std::vector<std::string> parts;
  const auto add = [&](double share, const char* text) {
    if (share >= kNotableShare) {
      parts.push_back(fmt::format("{:.1f} % {}", 100.0 * share, text));
    }
  };
  add(1.0 - share_of("homogeneity.lit_share").value_or(1.0), "of the scored surface is dark");
  add(share_of("homogeneity.clipped_share").value_or(0.0),
      parts.empty() ? "of the scored surface is at full scale in every frame"
                    : "of it is at full scale in every frame");
  add(share_of("view.hidden_share").value_or(0.0),
      "of the part is hidden from the camera by the wall");
  if (!parts.empty()) {
    findings.push_back(
        {"dark_part", fmt::format("{}: no defect can show there.", join(parts, ", "))});
  }
  if (const auto region = share_of("inspection.region_share");
      region && *region < 1.0 - kNotableShare) {
    findings.push_back(
        {"not_inspected",
         fmt::format("The inspection looks at {:.1f} % of the part; the rest is too dark or too "
                     "uneven.",
                     100.0 * *region)});
  }
}

/// The value that most of the evaluations have, how many do, and of how many.
struct CommonValue {
  double value = 0.0;
  int count = 0;
  int total = 0;

  bool is_flat() const {
    constexpr int kMin = 5;
    constexpr double kShare = 0.8;
    return total >= kMin && count >= kShare * total;
  }
};

/// Of evaluations that succeeded; where told so, of those among them that meet every limit.
CommonValue most_common_objective(const Json& trials, bool feasible_alone) {
  std::map<double, int> counts;
  CommonValue common;
  for (const Json& trial : trials) {
    const auto value = number_of(trial, "objective");
    const bool is_counted = !feasible_alone || member(trial, "feasible") != Json(false);
    if (!value || !is_counted || member(trial, "failed") == Json(true)) {
      continue;
    }
    ++common.total;
    if (const int count = ++counts[*value]; count > common.count) {
      common.count = count;
      common.value = *value;
    }
  }
  return common;
}

void add_flat_objective(const Json& data, const Wording& wording, std::vector<Finding>& findings) {
  for (const bool feasible_alone : {false, true}) {
    const CommonValue common = most_common_objective(member(data, "trials"), feasible_alone);
    if (common.is_flat()) {
      findings.push_back(
          {"objective_flat",
           fmt::format("{} of {} evaluations{} have the same {}, {}: the search could not tell "
                       "designs apart, and what it found is chance.",
                       common.count,
                       common.total,
                       feasible_alone ? " that meet every limit" : "",
                       wording.label(),
                       wording.text(common.value))});
      return;
    }
  }
}

void add_lost_limits(const Json& data, const Json& design, std::vector<Finding>& findings) {
  if (member(design, "feasible") != Json(true)) {
    return;
  }
  for (const Json& constraint : member(data, "constraints")) {
    const Wording wording(data, text_of(constraint, "name"), true);
    const auto fresh = number_of(member(design, "rescored"), wording.score());
    if (fresh && !meets(constraint, fresh)) {
      findings.push_back({"limit_lost",
                          fmt::format("With fresh seeds {}; in the search the limit was met.",
                                      missed_text(constraint, wording, *fresh))});
    }
  }
}

/// That what a score truly is lies within a limit, its deviation taken as normal.
/// @param noise  half the width of its interval of 95 %, > 0
double chance_within(const Json& constraint, double value, double noise) {
  const double deviation = 0.5 * noise;
  const auto chance_below = [&](const std::optional<double>& border, double without) {
    return border ? 0.5 * std::erfc((value - *border) / (std::sqrt(2.0) * deviation)) : without;
  };
  return chance_below(number_of(constraint, "max"), 1.0) -
         chance_below(number_of(constraint, "min"), 0.0);
}

/// Limits that are met, but not by more than noise; a bound of an interval has its noise in it.
void add_open_limits(const Json& data, const Json& design, std::vector<Finding>& findings) {
  constexpr double kSure = 0.95;
  if (member(design, "feasible") != Json(true)) {
    return;
  }
  for (const Json& constraint : member(data, "constraints")) {
    const Wording wording(data, text_of(constraint, "name"), true);
    const auto value = wording.value(design);
    const double noise = wording.noise(design).value_or(0.0);
    if (!meets(constraint, value) || !(noise > 0.0) || is_bound(wording.score())) {
      continue;
    }
    if (const double chance = chance_within(constraint, *value, noise); chance < kSure) {
      findings.push_back({"limit_open",
                          fmt::format("Noise may break a limit: {}, with a noise of {}. It is kept "
                                      "with a probability of {:.0f} %.",
                                      missed_text(constraint, wording, *value),
                                      wording.noise_text(noise),
                                      100.0 * chance)});
    }
  }
}

}  // namespace

Wording defect_wording(const Json& data) {
  Wording objective(data);
  if (is_about_defects(objective.score())) {
    return objective;
  }
  for (const Json& constraint : member(data, "constraints")) {
    const std::string name = text_of(constraint, "name");
    if (is_about_defects(name)) {
      return {data, name, number_of(constraint, "min").has_value()};
    }
  }
  return {data, "defects.min_cnr", true};
}

std::vector<Finding> findings_on(const Json& data, const Json& design) {
  std::vector<Finding> findings;
  add_flat_objective(data, Wording(data), findings);
  add_defects(data, design, findings);
  add_hidden_defects(data, design, findings);
  add_narrow_defects(design, findings);
  add_lost_limits(data, design, findings);
  add_open_limits(data, design, findings);
  std::ranges::move(findings_on_limits(data, design), std::back_inserter(findings));
  add_dark_part(data, design, findings);
  return findings;
}

std::vector<Finding> doubts_on_best_run(const Json& data, const Json& best, const Json* second) {
  const Wording wording = defect_wording(data);
  std::vector<Finding> findings;
  if (second != nullptr && wording.value(best) && wording.value(*second) &&
      compared(wording, best, *second) < 0) {
    findings.push_back({"defects_fainter",
                        fmt::format("In {} the worst defect shows {}.",
                                    title_of(best),
                                    comparison(wording, best, *second, title_of(*second), -1))});
  }
  add_hidden_defects(data, best, findings);
  for (const Json& doubt : member(best, "doubts")) {
    findings.push_back(
        {text_of(doubt, "code"), fmt::format("Of {}: {}", title_of(best), text_of(doubt, "text"))});
  }
  return findings;
}

}  // namespace glint::report_detail

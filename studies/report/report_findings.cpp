// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_findings.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"
#include "studies/report/report_verdict.h"

namespace glint::report_detail {
namespace {

using Json = nlohmann::ordered_json;

/// Below them a defect is not told from its background: Rose's criterion asks a signal for three to
/// five times the noise.
constexpr std::array kVisible = {std::pair<std::string_view, double>{"defects.min_cnr", 3.0},
                                 std::pair<std::string_view, double>{"defects.min_dprime", 5.0}};

constexpr double kSmallestWidth_px = 3.0;

/// Of a variable's range: nearer to its end it lies on its limit.
constexpr double kLimitShare = 0.02;

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
    if (!number_of(member(design, "scores"), "defects.made").value_or(0.0)) {
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

void add_hidden_defects(const Json& data, const Json& design, std::vector<Finding>& findings) {
  const Wording wording = defect_wording(data);
  const auto* row = std::ranges::find(
      kVisible, std::string_view(wording.score()), &std::pair<std::string_view, double>::first);
  const auto value = wording.value(design);
  if (row == kVisible.end() || !value || *value >= row->second) {
    return;
  }
  const double best = best_value(data, wording, *value);
  findings.push_back(
      {"defects_hidden",
       best < row->second
           ? fmt::format("No design here shows the worst defect: {} is {} at most, and below {:g} "
                         "it is not told from its background. Other lighting, another place or a "
                         "larger defect is needed.",
                         wording.label(),
                         wording.text(best),
                         row->second)
           : fmt::format("The worst defect hardly shows: {} is below {:g}; another design reached "
                         "{}.",
                         wording.label(),
                         row->second,
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

/// Which end of its range a variable lies on: -1, 0, 1.
int end_of(const Json& variable, double value) {
  const auto low = number_of(variable, "low");
  const auto high = number_of(variable, "high");
  if (!low || !high || !(*high > *low) || text_of(variable, "kind") == "choice") {
    return 0;
  }
  const bool is_log = member(variable, "log") == Json(true) && *low > 0.0 && value > 0.0;
  const double share =
      is_log ? std::log(value / *low) / std::log(*high / *low) : (value - *low) / (*high - *low);
  return share < kLimitShare ? -1 : share > 1.0 - kLimitShare ? 1 : 0;
}

/// Variables that differ in their number alone: control_mm.0, control_mm.1 ...
struct VariableFamily {
  std::string name;
  int count = 0;
  int on_limit = 0;
};

/// "lighting.tunnel.control_mm.2" -> "control point", "sensor.gain" -> "gain"
std::string spoken(const std::string& path, bool has_number) {
  std::vector<std::string> parts = split(path, '.');
  if (has_number) {
    parts.pop_back();
  }
  std::string word = parts.back();
  for (const std::string_view unit : {"_mm", "_deg", "_um", "_nm", "_px", "_e"}) {
    if (word.ends_with(unit)) {
      word.resize(word.size() - unit.size());
    }
  }
  std::ranges::replace(word, '_', ' ');
  return word == "control" ? "control point" : word;
}

bool ends_in_number(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot != std::string::npos && dot + 1 < path.size() &&
         path.find_first_not_of("0123456789", dot + 1) == std::string::npos;
}

std::string family_text(const VariableFamily& family) {
  if (family.count == 1) {
    return "the " + family.name;
  }
  return family.on_limit == family.count
             ? fmt::format("all {} {}s", family.count, family.name)
             : fmt::format("{} of {} {}s", family.on_limit, family.count, family.name);
}

/// "a", "a and b", "a, b and c"
std::string listed(const std::vector<std::string>& names) {
  const auto first = std::span(names).first(names.size() - 1);
  return first.empty() ? names.back() : join(first, ", ") + " and " + names.back();
}

/// What the ends that are met say about the best design.
std::string beyond(bool are_lengths, bool has_low, bool has_high) {
  if (are_lengths && has_low != has_high) {
    return has_high ? "the best design is larger than allowed"
                    : "the best design is smaller than allowed";
  }
  return "a better design may lie beyond them";
}

void add_limits(const Json& data, const Json& design, std::vector<Finding>& findings) {
  std::vector<VariableFamily> families;
  bool are_lengths = true;
  bool has_low = false;
  bool has_high = false;
  for (const Json& variable : member(data, "variables")) {
    const std::string path = text_of(variable, "name");
    const bool has_number = ends_in_number(path);
    const auto value = number_of(member(design, "variables"), path);
    const std::string name = spoken(path, has_number);
    auto family = std::ranges::find(families, name, &VariableFamily::name);
    if (family == families.end() || !has_number) {
      families.push_back({.name = name});
      family = families.end() - 1;
    }
    ++family->count;
    const int end = value ? end_of(variable, *value) : 0;
    family->on_limit += end != 0 ? 1 : 0;
    are_lengths = are_lengths && (end == 0 || text_of(variable, "unit") == "mm");
    has_low = has_low || end < 0;
    has_high = has_high || end > 0;
  }
  std::erase_if(families, [](const VariableFamily& family) { return family.on_limit == 0; });
  if (families.empty()) {
    return;
  }
  std::vector<std::string> names;
  std::ranges::transform(families, std::back_inserter(names), family_text);
  const bool is_one = families.size() == 1 && families.front().on_limit == 1;
  std::string list = listed(names);
  list.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(list.front())));
  findings.push_back({"on_limits",
                      fmt::format("{} {}: {}.",
                                  list,
                                  is_one ? "lies on its limit" : "lie on their limits",
                                  beyond(are_lengths, has_low, has_high))});
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
  add(share_of("homogeneity.clipped_share").value_or(0.0), "of it is at full scale in every frame");
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

void add_flat_objective(const Json& data, const Wording& wording, std::vector<Finding>& findings) {
  constexpr int kFewest = 5;
  constexpr double kShare = 0.8;
  std::map<double, int> counts;
  int total = 0;
  for (const Json& trial : member(data, "trials")) {
    if (const auto value = number_of(trial, "objective");
        value && member(trial, "failed") != Json(true)) {
      ++counts[*value];
      ++total;
    }
  }
  const auto most =
      std::ranges::max_element(counts, {}, [](const auto& pair) { return pair.second; });
  if (total >= kFewest && most->second >= kShare * total) {
    findings.push_back(
        {"objective_flat",
         fmt::format("{} of {} evaluations have the same {}, {}: the search had nothing to go by, "
                     "and what it found is chance.",
                     most->second,
                     total,
                     wording.label(),
                     wording.text(most->first))});
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
                          fmt::format("With fresh seeds {} is {}, must be {}; in the search "
                                      "the limit was met.",
                                      wording.label(),
                                      wording.text(*fresh),
                                      limit_text(constraint, wording))});
    }
  }
}

}  // namespace

Wording defect_wording(const Json& data) {
  const Wording objective(data);
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
  add_limits(data, design, findings);
  add_dark_part(data, design, findings);
  return findings;
}

}  // namespace glint::report_detail

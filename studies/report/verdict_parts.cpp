// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/verdict_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "studies/report/report_verdict.h"

namespace glint::report_detail {

using Json = nlohmann::ordered_json;

namespace {

/// Under noise, by what is expected of the limited scores. @param limits  of the design
void say_expected_limits(const Json& data, const Json& limits, bool is_feasible, Verdict& verdict) {
  const std::size_t count = member(data, "constraints").size();
  const std::string text =
      fmt::format("By {} it keeps {} with a probability of {:.0f} %",
                  text_of(limits, "by") == "replicates" ? "its replicates" : "the search's model",
                  count == 1   ? "the constraint"
                  : count == 2 ? "both constraints"
                               : fmt::format("all {} constraints", count),
                  std::floor(100.0 * number_of(limits, "probability").value_or(0.0)));
  if (is_feasible) {
    verdict.say("limits_met", text + ".");
    return;
  }
  verdict.say("limits_unlikely", text + " only.");
  for (const Json& constraint : member(data, "constraints")) {
    const std::string name = text_of(constraint, "name");
    const Wording wording(data, name, true);
    const auto value = number_of(member(member(limits, "scores"), name.c_str()), "value");
    if (value && !meets(constraint, value)) {
      verdict.say("limit_failed",
                  fmt::format("It is expected to miss a limit: {}.",
                              missed_text(constraint, wording, *value)));
    }
  }
}

}  // namespace

void Verdict::add(std::vector<Finding> more) {
  std::ranges::move(more, std::back_inserter(details));
}

bool Verdict::is_doubtful() const {
  constexpr std::array<std::string_view, 6> kDoubts = {"defects_fainter",
                                                       "defects_hidden",
                                                       "objective_flat",
                                                       "limit_lost",
                                                       "compromise_dominated",
                                                       "kind_ahead"};
  const auto is_doubt = [&](const Finding& finding) {
    return std::ranges::find(kDoubts, finding.code) != kDoubts.end();
  };
  return std::ranges::any_of(headline, is_doubt) || std::ranges::any_of(details, is_doubt);
}

void Verdict::judge(bool is_gain) {
  tone = is_gain && !is_doubtful() ? "good" : "neutral";
}

void say_limits(const Json& data, const Json& design, Verdict& verdict) {
  const std::size_t count = member(data, "constraints").size();
  const Json& feasible = member(design, "feasible");
  if (count == 0 || !feasible.is_boolean()) {
    return;
  }
  if (const Json& limits = member(design, "limits"); limits.is_object()) {
    say_expected_limits(data, limits, feasible.get<bool>(), verdict);
    return;
  }
  if (feasible.get<bool>()) {
    verdict.say("limits_met",
                count == 1   ? "It meets the constraint."
                : count == 2 ? "It meets both constraints."
                             : fmt::format("It meets all {} constraints.", count));
    return;
  }
  const std::vector<std::string> missed = missed_limits(data, design);
  if (missed.empty()) {
    verdict.say("limit_failed", "It does not meet every constraint.");
  }
  for (const std::string& text : missed) {
    verdict.say("limit_failed", fmt::format("It misses a limit: {}.", text));
  }
}

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

bool is_ahead(const Json& other, const Json& design, const Wording& wording) {
  const double value = *wording.value(design);
  const double there = *wording.value(other);
  const auto lead = lead_over(&other, design, wording);
  return wording.is_better(value, there) && !wording.is_level(value, there) &&
         (!lead || lead->is_sure());
}

}  // namespace glint::report_detail

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_kinds.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/text.h"
#include "studies/report/report_verdict.h"

namespace glint::report_detail {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKind = "lighting_use";

std::vector<Wording> wordings_of(const Json& data) {
  std::vector<Wording> wordings;
  for (const Json& objective : member(member(data, "front"), "objectives")) {
    wordings.emplace_back(
        data, text_of(objective, "score"), text_of(objective, "direction") == "maximise");
  }
  if (wordings.empty()) {
    wordings.emplace_back(data);
  }
  return wordings;
}

bool keeps_limits(const Json& kind) {
  return member(kind, "feasible") != Json(false);
}

/// "evaluation 12: smallest CNR 9.00, misses a limit"
std::string finalist_text(const std::vector<Wording>& wordings, const Json& kind) {
  std::vector<std::string> parts;
  for (const Wording& wording : wordings) {
    if (const auto value = wording.value(kind)) {
      parts.push_back(wording.label() + " " + wording.text(*value));
    }
  }
  if (!keeps_limits(kind)) {
    parts.emplace_back("misses a limit");
  }
  return fmt::format("evaluation {}: {}", member(kind, "trial").dump(), join(parts, ", "));
}

/// Whether the lead of one kind over another is larger than the noise of the two.
bool is_sure_lead(const Wording& wording, const Json& first, const Json& other) {
  const auto value = wording.value(first);
  const auto there = wording.value(other);
  const auto noise = wording.noise(first, other);
  return keeps_limits(other) && value && there && noise && std::abs(*value - *there) > *noise;
}

const Json* with_member(const Json& list, const char* name, const std::string& text) {
  for (const Json& one : list) {
    if (text_of(one, name) == text) {
      return &one;
    }
  }
  return nullptr;
}

}  // namespace

std::vector<Finding> findings_on_kinds(const Json& data) {
  const Json& kinds = member(data, "kinds");
  const Json* winner = with_member(member(data, "designs"), "key", "winner");
  const std::string chosen =
      winner == nullptr ? std::string() : text_of(member(*winner, "variables"), kKind);
  const Json* own = with_member(kinds, kKind, chosen);
  if (own == nullptr || own == &kinds.front() || !keeps_limits(kinds.front())) {
    return {};
  }
  const std::vector<Wording> wordings = wordings_of(data);
  const bool is_sure = is_sure_lead(wordings.front(), kinds.front(), *own);
  // An order of compromises says little; a race knows more than one evaluation each.
  if (wordings.size() > 1 || (data.contains("race") && !is_sure)) {
    return {};
  }
  return {{"kind_ahead",
           fmt::format(
               "Scored again with fresh random numbers, {} ({}) comes before {}, the "
               "winner's kind of light ({}): {}.",
               text_of(kinds.front(), kKind),
               finalist_text(wordings, kinds.front()),
               chosen,
               finalist_text(wordings, *own),
               is_sure ? "the lead is larger than the noise" : "which kind is better is open")}};
}

Json kinds_panel(const Json& data) {
  const std::vector<Wording> wordings = wordings_of(data);
  Json head = {"kind", "evaluation"};
  for (const Wording& wording : wordings) {
    head.push_back(wording.label() + " in the search");
    head.push_back(wording.label() + " scored again");
  }
  head.push_back("within limits");
  Json rows = Json::array();
  for (const Json& kind : data["kinds"]) {
    Json row = {text_of(kind, kKind), member(kind, "trial").dump()};
    for (const Wording& wording : wordings) {
      for (const auto& value : {wording.searched(kind), wording.value(kind)}) {
        row.push_back(value ? wording.text(*value) : std::string("\u2013"));
      }
    }
    row.push_back(keeps_limits(kind) ? "yes" : "no");
    rows.push_back(std::move(row));
  }
  return {{"id", "kinds"},
          {"title", "Kinds of light"},
          {"lead",
           "The best design of each kind, scored once more with fresh random numbers and finer "
           "sampling, all in the same way; the best of these comes first."},
          {"tables", {{{"caption", ""}, {"head", head}, {"rows", rows}}}}};
}

}  // namespace glint::report_detail

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/verdict_of_designs.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "studies/report/report_ranking.h"
#include "studies/report/report_verdict.h"

namespace glint::report_detail {
namespace {

using Json = nlohmann::ordered_json;

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

/// "The next, bar, is 2.00 behind. "; empty where the next one misses a limit, for it may be ahead.
std::string gap_text(const Json& ranking, const Wording& wording) {
  const double value = *number_of(ranking[0], "value");
  const double next = *number_of(ranking[1], "value");
  const bool is_compared = ranking[1]["missed"].empty() && !wording.is_better(next, value);
  return is_compared ? fmt::format("The next, {}, is {} behind. ",
                                   title_of(ranking[1]),
                                   wording.size(std::abs(value - next)))
                     : std::string();
}

/// How sure the first place of a ranking is. @return whether it is
bool add_certainty(const Json& ranking, const Wording& wording, Verdict& verdict) {
  constexpr double kSure = 0.95;
  const auto probability = number_of(ranking.front(), "probability_best");
  if (!probability || ranking.size() < 2) {
    return false;
  }
  const std::string text =
      fmt::format("{}With other noise {} would be the best {:.0f} times of 100.",
                  gap_text(ranking, wording),
                  title_of(ranking[0]),
                  100.0 * *probability);
  const bool is_sure = *probability >= kSure;
  verdict.details.push_back(is_sure ? Finding{"ranking_sure", text}
                                    : Finding{"ranking_open", text + " The order may be chance."});
  return is_sure;
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

/// The best of a ranking, and what the others miss. @return whether its lead is sure
bool say_ranking(const Json& data,
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
    return false;
  }
  verdict.say("ranked",
              fmt::format("Of {} designs, {} has the best {}: {}.",
                          member(data, "designs").size(),
                          title_of(first),
                          wording.label(),
                          ranked_value(first, wording)));
  say_limits(data, best, verdict);
  const bool is_sure = add_certainty(ranking, wording, verdict);
  add_missed(ranking, 1, verdict);
  return is_sure;
}

/// Designs of which none was searched for.
Verdict verdict_of_ranking(const Json& data, const Wording& wording) {
  Verdict verdict;
  const Json ranking = ranking_of(data);
  const auto& designs = member(data, "designs");
  const Json* best = &*std::ranges::find_if(designs, [&](const Json& design) {
    return text_of(design, "key") == text_of(ranking.front(), "key");
  });
  const bool is_sure = say_ranking(data, ranking, *best, wording, verdict);
  verdict.add(findings_on(data, *best));
  verdict.judge(is_sure && member(*best, "feasible") != Json(false));
  return verdict;
}

/// Designs without an objective: what can be said of the study's own.
Verdict verdict_without_objective(const Json& data) {
  const Json& designs = member(data, "designs");
  Verdict verdict;
  if (designs.empty()) {
    verdict.say("nothing_yet", "There is no result yet.");
    return verdict;
  }
  const auto own = std::ranges::find_if(
      designs, [](const Json& design) { return role_of(design) == "baseline"; });
  const Json& design = own == designs.end() ? designs.front() : *own;
  verdict.say("rendered",
              designs.size() == 1
                  ? std::string("The scene was rendered; no objective is set.")
                  : fmt::format("{} designs were rendered; no objective is set that would rank "
                                "them. What follows is of {}.",
                                designs.size(),
                                title_of(design)));
  verdict.add(findings_on(data, design));
  return verdict;
}

}  // namespace

Verdict verdict_of_designs(const Json& data, const Wording& wording) {
  const Json& designs = member(data, "designs");
  const Json* best = best_design(designs, wording, "");
  if (best == nullptr) {
    return verdict_without_objective(data);
  }
  if (designs.size() > 1) {
    return verdict_of_ranking(data, wording);
  }
  Verdict verdict;
  verdict.say(
      "one_design",
      fmt::format(
          "The design reaches {} {}.", wording.label(), wording.text(*wording.value(*best))));
  say_limits(data, *best, verdict);
  verdict.add(findings_on(data, *best));
  return verdict;
}

}  // namespace glint::report_detail

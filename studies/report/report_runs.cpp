// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_runs.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"
#include "studies/report/report_verdict.h"

namespace glint::report_detail {
namespace {

using Json = nlohmann::ordered_json;

/// The two best feasible runs; nullptr where there are fewer.
std::pair<const Json*, const Json*> best_two(const Json& runs, const Wording& wording) {
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
  return {best, second};
}

std::vector<Finding> differences(const Json& runs) {
  std::vector<Finding> findings;
  for (const Json& run : runs) {
    std::vector<std::string> texts;
    for (const Json& text : member(run, "differs")) {
      texts.push_back(text.get<std::string>());
    }
    if (!texts.empty()) {
      findings.push_back({"runs_differ",
                          fmt::format("{} differs from {} in {}.",
                                      title_of(run),
                                      title_of(runs.front()),
                                      join(texts, ", "))});
    }
  }
  return findings;
}

/// The runs of each group, in the order of the groups' first runs.
std::vector<Json> grouped(const Json& runs) {
  std::map<double, Json> groups;
  for (const Json& run : runs) {
    groups[number_of(run, "group").value_or(0.0)].push_back(run);
  }
  std::vector<Json> lists;
  for (auto& [group, list] : groups) {
    lists.push_back(std::move(list));
  }
  return lists;
}

/// Of the objective of these runs; without a score where others have one and these do not.
Wording wording_of(const Json& data, const Json& runs) {
  const Json& objective = member(runs.front(), "objective");
  const bool is_told = std::ranges::any_of(
      member(data, "runs"), [](const Json& run) { return member(run, "objective").is_object(); });
  return is_told ? Wording(data,
                           text_of(objective, "name"),
                           !text_of(objective, "sense").starts_with("min"))
                 : Wording(data);
}

/// "dome, lights for the gear" where one design of several stands for the run.
std::string name_of(const Json& run) {
  const std::string design = text_of(run, "design");
  return design.empty() ? title_of(run) : design + ", " + title_of(run);
}

/// Scores of all designs of these runs, as evaluations.
Json scores_of_designs(const Json& data, const Json& runs) {
  Json scores = Json::array();
  for (const Json& design : member(data, "designs")) {
    const bool is_of_these = std::ranges::any_of(
        runs, [&](const Json& run) { return text_of(run, "title") == text_of(design, "run"); });
    if (is_of_these) {
      scores.push_back({{"scores", member(design, "scores")}});
    }
  }
  return scores;
}

void say_best(const Json& runs,
              const Json& best,
              const Json* second,
              const Wording& wording,
              Verdict& verdict) {
  const double value = *wording.value(best);
  const std::string gap =
      second == nullptr
          ? std::string()
          : fmt::format(
                ", {} {}", wording.against(value, *wording.value(*second)), name_of(*second));
  verdict.say("runs_ranked",
              fmt::format("Of {} runs, {} has the best {}: {}{}.",
                          runs.size(),
                          name_of(best),
                          wording.label(),
                          wording.text(value),
                          gap));
}

/// Says which of some comparable runs is the best. @return its verdict
Verdict ranked(const Json& data, const Json& runs) {
  const Wording wording = wording_of(data, runs);
  Verdict verdict;
  if (wording.score().empty()) {
    verdict.say("rendered",
                fmt::format("{} runs were rendered; no objective is set that would rank them.",
                            runs.size()));
    return verdict;
  }
  const auto [best, second] = best_two(runs, wording);
  if (best == nullptr) {
    verdict.tone = "bad";
    verdict.say("runs_infeasible",
                fmt::format("None of the {} runs has a feasible design.", runs.size()));
    return verdict;
  }
  say_best(runs, *best, second, wording, verdict);
  verdict.add(doubts_on_best_run({{"objective", member(runs.front(), "objective")},
                                  {"constraints", member(*best, "constraints")},
                                  {"designs", runs},
                                  {"trials", scores_of_designs(data, runs)},
                                  {"score_info", member(data, "score_info")}},
                                 *best,
                                 second));
  verdict.judge(second == nullptr || is_ahead(*second, *best, wording));
  return verdict;
}

}  // namespace

Verdict verdict_of_runs(const Json& data) {
  const Json& runs = member(data, "runs");
  Verdict verdict;
  const std::vector<Json> groups = grouped(runs);
  if (groups.size() == 1) {
    verdict = ranked(data, runs);
  } else {
    verdict.say(
        "runs_apart",
        fmt::format(
            "These {} runs are not ranked together: they do not all have the same "
            "part, material, camera, defects, scored region, inspection, objective and what "
            "that is measured by.",
            runs.size()));
  }
  for (const Json& group : groups) {
    if (groups.size() > 1 && group.size() > 1) {
      Verdict of_group = ranked(data, group);
      verdict.add(std::move(of_group.headline));
      verdict.add(std::move(of_group.details));
    }
  }
  verdict.add(differences(runs));
  return verdict;
}

}  // namespace glint::report_detail

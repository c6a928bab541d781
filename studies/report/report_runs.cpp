// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_runs.h"

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

/// Which of some comparable runs is the best.
Finding ranked(const Json& runs, const Wording& wording) {
  const auto [best, second] = best_two(runs, wording);
  if (best == nullptr) {
    return {"runs_infeasible",
            fmt::format("None of the {} runs has a feasible design.", runs.size())};
  }
  const double value = *wording.value(*best);
  const std::string gap =
      second == nullptr
          ? std::string()
          : fmt::format(
                ", {} {}", wording.against(value, *wording.value(*second)), title_of(*second));
  return {"runs_ranked",
          fmt::format("Of {} runs, {} has the best {}: {}{}.",
                      runs.size(),
                      title_of(*best),
                      wording.label(),
                      wording.text(value),
                      gap)};
}

/// Of the objective of these runs.
Wording wording_of(const Json& data, const Json& runs) {
  const Json& objective = member(runs.front(), "objective");
  return objective.is_object() ? Wording(data,
                                         text_of(objective, "name"),
                                         !text_of(objective, "sense").starts_with("min"))
                               : Wording(data);
}

}  // namespace

RunsVerdict verdict_of_runs(const Json& data) {
  const Json& runs = member(data, "runs");
  RunsVerdict verdict;
  const std::vector<Json> groups = grouped(runs);
  if (groups.size() == 1) {
    verdict.headline = ranked(runs, wording_of(data, runs));
    verdict.tone = verdict.headline.code == "runs_ranked" ? "good" : "bad";
  } else {
    verdict.headline = {"runs_apart",
                        fmt::format("These {} runs are not ranked together: they do not all have "
                                    "the same part, camera, defects and objective.",
                                    runs.size())};
  }
  for (const Json& group : groups) {
    if (groups.size() > 1 && group.size() > 1) {
      verdict.details.push_back(ranked(group, wording_of(data, group)));
    }
  }
  for (Finding& difference : differences(runs)) {
    verdict.details.push_back(std::move(difference));
  }
  return verdict;
}

}  // namespace glint::report_detail

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/front/front_run.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/log.h"
#include "optimizer/search/expected_limits.h"
#include "studies/front/front_designs.h"
#include "studies/front/front_page.h"
#include "studies/front/front_probability.h"
#include "studies/output/read_json.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kWinner = "winner";

/// Whether a score of the design has no standard error of its own.
bool lacks_errors(const Study& study, const Json& design) {
  return std::ssize(design["errors"]) < num_objectives(study.goal);
}

/// With other noise.
int scans_of(const Json& written) {
  const Json repeated = written.value("repeated", Json::object());
  return repeated.empty() ? 0 : static_cast<int>(repeated.begin()->size());
}

/// Its limits are judged as in the front, where models judge them.
Json write_full(const FrontTask& task, const SceneSettings& scene, const Json& design) {
  const int trial = design["trial"];
  Json head = {{"title", fmt::format("Evaluation {}", trial)},
               {"study", task.study.title},
               {"role", "front"},
               {"variables", design["variables"]},
               {"trial", trial}};
  if (design.contains("limits")) {
    head["feasible"] = design["limits"]["probability"].get<double>() >= kFeasibleChance;
    head["limits"] = design["limits"];
  }
  return task.write(design["folder"], scene, head, lacks_errors(task.study, design));
}

/// The prototypes, as they were written before.
std::vector<Finalist> prototypes_of(const FrontTask& task) {
  std::vector<Finalist> finalists;
  for (const Prototype& prototype : task.study.prototypes) {
    finalists.push_back({.key = prototype.name,
                         .title = prototype.title,
                         .written = read_json(task.out / prototype.name / "scores.json")});
  }
  return finalists;
}

}  // namespace

int full_designs_of_front(const Json& front) {
  return static_cast<int>(std::ranges::count_if(front["designs"], [](const Json& design) {
    return design["shown"] == "full" && design["folder"] != kWinner;
  }));
}

void add_front_to_result(const Json& front, Json& result) {
  if (front.is_null()) {
    return;
  }
  result["objectives"] = front["objectives"];
  result["front"] = front["designs"];
  for (const char* name : {"hypervolume", "reference", "chosen"}) {
    result[name] = front[name];
  }
  if (front.contains("is_expected") || front.contains("is_likely")) {
    const char* kept = front.contains("is_expected") ? "front_expected" : "front_likely";
    for (const char* name : kOfExpected) {
      result[kept][name] = front[name];
    }
  }
}

void write_front(const FrontTask& task, const Json& winner, Json& front, Json& result) {
  remove_other_designs(task.out, front);
  const std::vector<Trial> trials = task.storage.trials(TrialKind::kSearch);
  int evaluations = 0;
  std::vector<Finalist> finalists = prototypes_of(task);
  for (Json& design : front["designs"]) {
    if (task.interrupt != nullptr && *task.interrupt > 0) {
      log(LogLevel::kWarning, "interrupted; the same command writes the rest of the front");
      result["status"] = "interrupted";
      return;
    }
    const int number = design["trial"];
    const Point& point = trials[static_cast<std::size_t>(number - 1)].point;
    const SceneSettings scene = scene_with(task.study, overrides_of(task.study, point));
    if (design["shown"] == "full") {
      const bool is_winner = design["folder"] == kWinner;
      const Json written = is_winner ? winner : write_full(task, scene, design);
      add_rescored(task.study.goal, written, design);
      evaluations += is_winner ? 0 : 1 + scans_of(written);
      finalists.push_back({.key = design["folder"],
                           .title = fmt::format("Evaluation {}", number),
                           .written = written});
    } else if (design["shown"] == "thumbnail") {
      write_thumbnail(task.store,
                      scene,
                      fmt::format("{} - evaluation {}", task.study.title, number),
                      task.wanted,
                      task.drawing,
                      task.out / design["folder"].get<std::string>());
    }
  }
  result["front_rescored"] = judge_front(task.study.goal, front);
  result["front_rescored"]["evaluations"] = evaluations;
  add_probability_best(task.study.goal, finalists, front, result);
  result["front"] = front["designs"];
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/run_texts.h"

#include <algorithm>
#include <set>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/file.h"
#include "core/progress.h"
#include "core/text.h"
#include "studies/definition/scene_notes.h"
#include "studies/front/front_files.h"
#include "studies/report/report.h"
#include "studies/run/run_report.h"

namespace glint {

std::string limits_text(const Budget& budget) {
  std::vector<std::string> limits;
  if (budget.evaluations > 0) {
    limits.push_back(fmt::format("after {} evaluations (budget.evaluations)", budget.evaluations));
  }
  if (budget.wall_clock_s > 0.0) {
    limits.push_back(fmt::format("after {} of searching (budget.wall_clock or --budget)",
                                 duration_text(budget.wall_clock_s)));
  }
  if (budget.stall > 0) {
    limits.push_back(
        fmt::format("after {} evaluations without a better design (budget.stall)", budget.stall));
  }
  if (budget.target) {
    limits.push_back(fmt::format("at {} (budget.target)", shortest(*budget.target)));
  }
  return join(limits, " or ") + (limits.size() > 1 ? ", whichever comes first" : "");
}

std::string ended_by(Termination termination) {
  switch (termination) {
    case Termination::kEvaluations:
      return "budget.evaluations";
    case Termination::kWallClock:
      return "budget.wall_clock";
    case Termination::kStall:
      return "budget.stall";
    case Termination::kTarget:
      return "budget.target";
    case Termination::kInterrupted:
      return "an interrupt";
    case Termination::kExhausted:
      return "the search space, of which every design has been evaluated";
    case Termination::kFailures:
      break;
  }
  return "the first ten evaluations, which all failed";
}

std::string progress_note(const Goal& goal, const SearchProgress& progress) {
  std::string note = "best -";
  if (progress.best && progress.best->outcome) {
    const Scores& scores = progress.best->outcome->scores;
    note = progress.on_front > 0       ? fmt::format("front of {}", progress.on_front)
           : is_feasible(goal, scores) ? fmt::format("best {:.4f}", scores.at(goal.objective.name))
                                       : "none feasible yet";
  }
  return progress.failed > 0 ? note + fmt::format(", {} failed", progress.failed) : note;
}

std::string changes_text(const std::vector<std::string>& changes) {
  constexpr std::size_t kMaxTold = 3;
  if (changes.empty()) {
    return "the content of a file that it names has changed";
  }
  const std::size_t told = std::min(changes.size(), kMaxTold);
  std::string text = join(std::span(changes).first(told), ", ");
  return changes.size() == told ? text : fmt::format("{} and {} more", text, changes.size() - told);
}

std::string baseline_title(const Study& study) {
  const auto sets_lights = [](const Prototype& prototype) {
    return std::ranges::any_of(prototype.overrides, [](const auto& one) {
      return one.first == "lighting" || one.first == "lighting_use";
    });
  };
  if (study.has_search() || study.has_population() ||
      std::ranges::none_of(study.prototypes, sets_lights)) {
    return "Baseline";
  }
  return fmt::format("Baseline ({})", join(light_titles(study.scene), ", "));
}

namespace {

/// Of a trial's variable; empty where a condition leaves the file's own value in its place.
std::string value_text(const SearchSpace& space, const Point& point, std::size_t index) {
  if (!is_active(space, point, index)) {
    return "";
  }
  const Variable& variable = space.variables[index];
  return variable.kind == Variable::Kind::kChoice
             ? variable.choices[static_cast<std::size_t>(point[index])]
             : shortest(point[index]);
}

}  // namespace

std::string trials_csv(const Study& study, const Storage& storage) {
  const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
  std::set<std::string> names;
  for (const Trial& trial : trials) {
    if (trial.outcome) {
      for (const auto& [name, value] : trial.outcome->scores) {
        names.insert(name);
      }
    }
  }
  std::vector<std::string> fields = {"trial", "state", "feasible"};
  for (const Variable& variable : study.space.variables) {
    fields.push_back(variable.name);
  }
  fields.insert(fields.end(), names.begin(), names.end());
  fields.emplace_back("message");
  std::string csv = csv_row(fields);
  for (const Trial& trial : trials) {
    const Outcome outcome = trial.outcome.value_or(Outcome{});
    const bool has_scores = trial.outcome && !outcome.is_failed;
    fields = {std::to_string(trial.number),
              !trial.outcome      ? "asked"
              : outcome.is_failed ? "failed"
                                  : "done",
              !has_scores                               ? ""
              : is_feasible(study.goal, outcome.scores) ? "true"
                                                        : "false"};
    for (std::size_t i = 0; i < trial.point.size(); ++i) {
      fields.push_back(value_text(study.space, trial.point, i));
    }
    for (const std::string& name : names) {
      const auto found = outcome.scores.find(name);
      fields.push_back(has_scores && found != outcome.scores.end() ? shortest(found->second) : "");
    }
    fields.push_back(outcome.is_failed ? outcome.message : text_of(outcome.remarks));
    csv += csv_row(fields);
  }
  return csv;
}

std::string run_status(const SearchResult& search, bool has_search) {
  if (!has_search) {
    return "done";
  }
  if (search.termination == Termination::kInterrupted) {
    return "interrupted";
  }
  if (!search.best || !search.is_feasible) {
    return "no_feasible";
  }
  return search.termination == Termination::kWallClock ? "budget" : "done";
}

nlohmann::ordered_json with_report(nlohmann::ordered_json result,
                                   const std::filesystem::path& out) {
  using Json = nlohmann::ordered_json;
  const std::filesystem::path report = out / "report.html";
  const Json data = report_data({out});
  const Json& verdict = data["verdict"];
  result["verdict"] = {{"sentence", verdict["sentence"]},
                       {"tone", verdict["tone"]},
                       {"findings", verdict.value("findings", Json::array())}};
  for (const char* name : {"ranking", "probability_best"}) {
    if (data.contains(name)) {
      result[name] = data[name];
    }
  }
  write_file(out / "result.json", result.dump(2) + "\n");
  write_file(report, render_report(data));
  result["report"] = report.string();
  return result;
}

std::vector<std::string> names_in_run(const Study& study) {
  std::vector<std::string> names = {"baseline",
                                    "winner",
                                    "result.json",
                                    "run.json",
                                    "report.html",
                                    "log.txt",
                                    "study.resolved.toml",
                                    "trials.csv",
                                    "sorting.csv",
                                    "sorting_sizes.json",
                                    "pod.csv",
                                    "pod_curves.json"};
  if (has_several_objectives(study.goal)) {
    names.emplace_back(kFrontFolder);
  }
  for (const Prototype& prototype : study.prototypes) {
    names.push_back(prototype.name);
  }
  return names;
}

}  // namespace glint

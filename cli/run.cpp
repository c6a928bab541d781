// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/run.h"

#include <algorithm>
#include <atomic>
#include <iostream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "cli/acquire/driven_session.h"
#include "cli/acquire/validation.h"
#include "cli/commands.h"
#include "cli/shell/counted.h"
#include "cli/shell/interrupts.h"
#include "cli/shell/scores_text.h"
#include "core/text.h"
#include "studies/accuracy/accuracy_panel.h"
#include "studies/calibration_trial/trial_run.h"
#include "studies/cell/cell_file.h"
#include "studies/population/population_report.h"
#include "studies/run/check_study.h"
#include "studies/run/render_study.h"
#include "studies/run/render_views.h"
#include "studies/run/run_texts.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string score_text(const Json& scores, const std::string& name) {
  if (!scores.is_object() || !scores.contains(name)) {
    return "-";
  }
  const auto value = scores[name].get<double>();
  return name.starts_with("homogeneity.h_") ? fmt::format("{:.2f} %", 100.0 * value)
                                            : fmt::format("{:.4g}", value);
}

/// A table of designs with the scores people ask for first.
class ScoreTable {
 public:
  explicit ScoreTable(const Json& result) {
    names_ = {"homogeneity.h_rms", "homogeneity.h_abs", "defects.min_cnr"};
    const std::string objective = result.value("objective", "");
    if (!objective.empty() && std::ranges::find(names_, objective) == names_.end()) {
      names_.insert(names_.begin(), objective);
    }
    text_ = fmt::format("  {:<24}", "");
    for (const std::string& name : names_) {
      text_ += fmt::format(" {:>12}", name.substr(name.rfind('.') + 1));
    }
    text_ += "\n";
  }

  void add(const std::string& design, const Json& scores) {
    text_ += fmt::format("  {:<24}", design);
    for (const std::string& name : names_) {
      text_ += fmt::format(" {:>12}", score_text(scores, name));
    }
    text_ += "\n";
  }

  void add_prototypes(const Json& result) {
    for (const auto& [name, prototype] : result["prototypes"].items()) {
      add(name, prototype["scores"]);
    }
  }

  const std::string& text() const { return text_; }

 private:
  std::vector<std::string> names_;
  std::string text_;
};

/// "done: 200 evaluations, 0 failed", "no feasible design: ...", "done: 3 designs, no search"
std::string outcome(const Json& result) {
  const auto status = result["status"].get<std::string>();
  const std::string words = status == "no_feasible" ? "no feasible design" : status;
  const auto evaluations = result["evaluations"].get<std::size_t>();
  const bool has_searched = result.contains("ended_by");
  return evaluations == 0 && !has_searched
             ? fmt::format(
                   "{}: {}, no search\n", words, counted(1 + result["prototypes"].size(), "design"))
             : fmt::format(
                   "{}: {}, {} failed{}\n",
                   words,
                   counted(evaluations, "evaluation"),
                   result["failed"].get<int>(),
                   has_searched ? "; ended by " + result["ended_by"].get<std::string>() : "");
}

/// The sentences of the verdict, one a line.
std::string verdict_lines(const Json& result) {
  std::string text;
  const Json verdict = result.value("verdict", Json::object());
  for (const Json& finding : verdict.value("findings", Json::array())) {
    text += fmt::format("  {}\n", finding["text"].get<std::string>());
  }
  return text;
}

/// A line for each variable of the winner.
std::string variables_text(const Json& variables) {
  std::string text;
  for (const auto& [name, value] : variables.items()) {
    text +=
        fmt::format("  {} = {}\n",
                    name,
                    value.is_number() ? fmt::format("{:.6g}", value.get<double>()) : value.dump());
  }
  return text;
}

std::string summary(const Json& result) {
  std::string text = outcome(result);
  ScoreTable table(result);
  table.add("baseline", result["baseline"]["scores"]);
  table.add_prototypes(result);
  const bool has_winner = !result["best"].is_null();
  if (has_winner) {
    const char* name = result["status"] == "no_feasible" ? "closest" : "winner";
    table.add(fmt::format("{} (trial {})", name, result["best"]["trial"].get<int>()),
              result["best"]["scores"]);
    table.add(fmt::format("{}, re-scored", name), result["rescored"]["best"]);
  }
  text += table.text();
  if (has_winner) {
    text += variables_text(result["best"]["variables"]);
  }
  if (result.contains("accuracy")) {
    text += accuracy_text(result["accuracy"]);
  }
  text += verdict_lines(result) + population_summary(result);
  return text + fmt::format("report: {}\n", result["report"].get<std::string>());
}

int jobs_of(const StudyArguments& arguments, const CommonArguments& common) {
  return arguments.jobs > 0 ? arguments.jobs : common.threads;
}

int run_trial_command(const Study& study,
                      const StudyArguments& arguments,
                      const CommonArguments& common) {
  const Json result = run_calibration_trial(study,
                                            {.out = out_folder(arguments, study, ResultKind::kRun),
                                             .threads = common.threads,
                                             .progress = common.progress(),
                                             .interrupt = &take_interrupts()});
  print_result(common, result, trial_summary(result));
  return result["status"] == "interrupted" ? kExitInterrupted : kExitDone;
}

/// The robot takes part only where the study asks for it. What is wrong with its cell should come
/// up now, not after the search.
/// @return with the cell that the study names, where views are to be planned for that
AcquireArguments checked_driven(const Study& study, AcquireArguments driven) {
  if (driven.is_move && driven.cell.empty()) {
    throw ConfigError("glint run --move: needs --cell with the file of the cell that may move");
  }
  if (!driven.cell.empty() && !study.scene.validate) {
    throw ConfigError(
        "glint run --cell: the study has no table [validate], so there is nothing to try out on a "
        "robot");
  }
  if (study.scene.validate && !driven.is_move) {
    driven.cell = planned_cell(study, driven);
  }
  if (driven.is_move) {
    throw_if_any(shared_outputs(driven_cell(driven)));
  } else if (!driven.cell.empty()) {  // twins that are told of may begin to serve later
    read_cell(driven.cell);
  }
  return driven;
}

}  // namespace

int run_command(const StudyArguments& arguments,
                const AcquireArguments& given,
                const CommonArguments& common) {
  const Study study = load_study(arguments);
  const AcquireArguments driven = checked_driven(study, given);
  const std::atomic<int>& interrupts = take_interrupts();
  if (study.calibration_trial) {
    return run_trial_command(study, arguments, common);
  }
  if (!arguments.budget.empty() && study.has_search() && !common.is_quiet) {
    std::cerr << fmt::format("the search ends {}\n", limits_text(study.budget));
  }
  std::filesystem::path out = out_folder(arguments, study, ResultKind::kRun);
  if (!out.has_filename()) {  // "out/run/"
    out = out.parent_path();
  }
  Json result = run_study(study,
                          {.out = out,
                           .threads = common.threads,
                           .jobs = jobs_of(arguments, common),
                           .progress = common.progress(),
                           .log_file = common.log_file,
                           .interrupt = &interrupts,
                           .from = arguments.from,
                           .verify_replay = arguments.verify_replay});
  const bool is_interrupted = result["status"] == "interrupted";
  AcquireAnswer end;
  if (study.scene.validate && !is_interrupted) {
    try {
      end = end_of_run(study, out, driven, common.threads, common.progress());
    } catch (const Error&) {  // the night's result is told before it
      print_result(common, result, summary(result));
      throw;
    }
    result.update(end.json);
  }
  print_result(common, result, summary(result) + end.text);
  if (is_interrupted) {
    return kExitInterrupted;
  }
  return result["status"] == "no_feasible" ? kExitNegative : end.exit_code;
}

namespace {

/// Which CPU time goes where, as "search 3 min, writing 4 s".
std::string cost_parts_text(const Json& cpu_s) {
  std::vector<std::string> parts;
  for (const auto& [name, what] : {std::pair{"search", "search"},
                                   {"rescoring", "re-scoring"},
                                   {"writing", "writing"},
                                   {"manufacture", "designs as built"},
                                   {"populations", "parts of the populations"}}) {
    if (cpu_s.contains(name) && cpu_s[name].is_number() && cpu_s[name].get<double>() > 0.0) {
      parts.push_back(fmt::format("{} {}", what, duration_text(cpu_s[name].get<double>())));
    }
  }
  return join(parts, ", ");
}

/// "0.120 CPU s an evaluation, 300 evaluations"
std::string evaluations_text(const Json& result) {
  return fmt::format("{:.3f} CPU s an evaluation, {}{}\n",
                     result["seconds_per_evaluation"].get<double>(),
                     counted(result["evaluations"].get<std::size_t>(), "evaluation"),
                     result["is_lower_bound"].get<bool>()
                         ? " or more: threads without a candidate of their own help"
                         : "");
}

/// What a run will cost, apart and together.
std::string cost_text(const Json& result) {
  const Json& cpu_s = result["predicted_cpu_s"];
  const bool is_known = !result["evaluations"].is_null();
  std::string text;
  if (!is_known) {
    text += fmt::format(
        "{:.3f} CPU s an evaluation; how many there will be cannot be predicted: only budget.stall "
        "or budget.target ends the search\n",
        result["seconds_per_evaluation"].get<double>());
  } else if (result["evaluations"].get<int>() > 0) {
    text += evaluations_text(result);
  }
  if (result.contains("manufacture_evaluations")) {
    text += fmt::format("at most {} more evaluations of designs as they will be built\n",
                        result["manufacture_evaluations"].get<int>());
  }
  if (!is_known) {
    return text + fmt::format("beside the search: {} of CPU time\n", cost_parts_text(cpu_s));
  }
  return text + fmt::format("about {} of CPU time ({}), {} on this machine when it is idle\n",
                            duration_text(cpu_s["total"].get<double>()),
                            cost_parts_text(cpu_s),
                            duration_text(result["predicted_s"].get<double>()));
}

std::vector<std::string> warnings_of(const Json& result) {
  std::vector<std::string> warnings;
  if (result.value("is_objective_flat", false)) {
    warnings.emplace_back(
        "the objective is the same at both ends of every variable and in the other designs that "
        "were looked at: a search could not tell designs apart");
  }
  for (const Json& name : result["insensitive_variables"]) {
    warnings.push_back(fmt::format("{} changes nothing in this scene", name.get<std::string>()));
  }
  for (const Json& limit : result["broken_limits"]) {
    warnings.push_back(limit.get<std::string>());
  }
  return warnings;
}

/// "gear: the study is sound, 2 variables", "gear: the study can be run, 1 warning, 2 variables"
std::string checked_text(const std::string& name, std::size_t warnings, std::size_t variables) {
  return fmt::format(
      "{}: the study {}, {}\n",
      name,
      warnings == 0 ? std::string("is sound") : "can be run, " + counted(warnings, "warning"),
      counted(variables, "variable"));
}

}  // namespace

int check_command(const StudyArguments& arguments, const CommonArguments& common) {
  const Study study = load_study(arguments);
  if (study.calibration_trial) {
    const Json result = check_calibration_trial(study, common.threads);
    print_result(common, result, trial_check_text(result));
    return kExitDone;
  }
  const Json result = check_study(study,
                                  {.threads = common.threads,
                                   .jobs = jobs_of(arguments, common),
                                   .progress = common.progress()});
  const std::vector<std::string> warnings = warnings_of(result);
  std::string text =
      checked_text(study.name, warnings.size(), result["variables"].get<std::size_t>());
  ScoreTable table(result);
  table.add("baseline", result["baseline"]["scores"]);
  table.add_prototypes(result);
  text += table.text();
  for (const Json& note : result["baseline"]["notes"]) {
    text += "  note: " + note.get<std::string>() + "\n";
  }
  for (const std::string& warning : warnings) {
    text += "  warning: " + warning + "\n";
  }
  if (result.contains("accuracy")) {
    text += accuracy_text(result["accuracy"]);
    for (const Json& note : result["accuracy"]["not_modelled"]) {
      text += "  note: " + note.get<std::string>() + "\n";
    }
  }
  print_result(common, result, text + cost_text(result));
  return kExitDone;
}

int render_command(const StudyArguments& arguments, const CommonArguments& common) {
  const Study study = load_study(arguments);
  const std::filesystem::path out = out_folder(arguments, study, ResultKind::kRender);
  const bool is_views = arguments.is_masks || allows_many_viewpoints(study.scene);
  const Json result = is_views ? render_views(study,
                                              {.out = out,
                                               .threads = common.threads,
                                               .has_light = !arguments.is_masks,
                                               .progress = common.progress(),
                                               .interrupt = &take_interrupts()})
                               : render_study(study, out, common.threads);
  std::string text = scores_text(result.value("scores", Json::object()));
  if (is_views) {
    for (const Json& note : result["notes"]) {
      text += "  note: " + note.get<std::string>() + "\n";
    }
  }
  text += fmt::format("pictures: {}\nreport: {}\n",
                      result["folder"].get<std::string>(),
                      result["report"].get<std::string>());
  print_result(common, result, text);
  return result["status"] == "interrupted" ? kExitInterrupted : kExitDone;
}

}  // namespace glint

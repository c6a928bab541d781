// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/acquire/validation.h"

#include <fmt/format.h>

#include "cli/acquire/driven_session.h"
#include "cli/shell/exit_codes.h"
#include "core/error.h"
#include "core/shell_word.h"
#include "studies/cell/typed_permit.h"
#include "studies/plan/plan_page.h"
#include "studies/plan/plan_run.h"
#include "studies/reach/scene_cell.h"
#include "studies/validate_cell/validate_cell_run.h"
#include "studies/validate_cell/validation_steps.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// A number, or a dash where there is none.
std::string cell(const Json& value, int digits) {
  return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), digits) : std::string("-");
}

constexpr const char* kDesignRow = "  {:<20} {:>6} {:>14} {:>14} {:>12}\n";

/// What each design scores on both sides.
std::string designs_text(const Json& result) {
  const std::string objective = result["objective"]["name"].get<std::string>();
  std::string text = fmt::format(kDesignRow, "design", "views", "simulated", "real", objective);
  for (const Json& design : result["designs"]) {
    const Json& scores = design["scores"];
    const bool is_scored = scores.is_object() && scores.contains(objective);
    const auto side = [&](const char* name) {
      return is_scored ? cell(scores[objective][name]["value"], 4) : std::string("-");
    };
    text += fmt::format(kDesignRow,
                        design["name"].get<std::string>(),
                        design["views"].get<int>(),
                        side("simulated"),
                        side("real"),
                        "");
  }
  return text;
}

std::string validation_text(const Json& result) {
  std::string text = designs_text(result);
  const Json& edges = result["edges"];
  text += fmt::format("edges: {} px before the calibration, {} px after it, limit {} px\n",
                      cell(edges["before_calibration_px"], 2),
                      cell(edges["mean_distance_px"], 2),
                      cell(edges["limit_px"], 2));
  for (const Json& cause : result["causes"]) {
    text += fmt::format("  {}{}{}\n",
                        cause["name"].get<std::string>(),
                        cause["of"].is_string() ? " of " + cause["of"].get<std::string>() : "",
                        cause["within_tolerance"].get<bool>() ? " (within tolerance)" : "");
    for (const auto& [name, value] : cause["values"].items()) {
      text += fmt::format(
          "    {:<12} {:>10} +- {}\n", name, cell(value["value"], 4), cell(value["sigma"], 4));
    }
  }
  for (const Json& number : result["undetermined"]) {
    text += fmt::format("  {}\n", number["text"].get<std::string>());
  }
  for (const char* key : {"advice", "notes"}) {
    for (const Json& line : result[key]) {
      text += fmt::format(
          "{}: {}\n", key == std::string("notes") ? "note" : key, line.get<std::string>());
    }
  }
  return text + fmt::format("{}\nreport: {}\n",
                            result["verdict"].get<std::string>(),
                            result["report"].get<std::string>());
}

ValidateOptions options_of(const ValidationArguments& arguments, Progress::Style progress) {
  return {.run = arguments.run,
          .pictures = arguments.pictures,
          .out = arguments.acquire.out,
          .calibration = arguments.calibration,
          .designs = arguments.designs,
          .is_refitting = arguments.is_refitting,
          .threads = arguments.threads,
          .progress = progress};
}

AcquireAnswer answer_of(const Json& result) {
  return {.json = result,
          .text = validation_text(result),
          .exit_code = result["agreement"] == "does_not_agree" ? kExitNegative : kExitDone};
}

AcquireAnswer validate_with_robot(const ValidationArguments& arguments, Progress::Style progress) {
  const MotionPermit permit = typed_permit(arguments.acquire.is_move, "validate --cell");
  ValidateCellOptions options = {.validate = options_of(arguments, progress),
                                 .acquire = driven_options(arguments.acquire)};
  DrivenSession session(progress == Progress::Style::kNone);
  session.attend(options.acquire);
  const Json result = validate_in_cell(options, permit);
  if (!result["agreement"].is_null()) {
    return answer_of(result);
  }
  AcquireAnswer answer = acquire_answer(result, arguments.again);
  answer.text = fmt::format("{}: {}", result["design"].get<std::string>(), answer.text);
  return answer;
}

/// What is left to do on the real cell.
AcquireAnswer told_steps(const std::vector<std::string>& steps) {
  std::string text = "to try the designs out on the real cell:\n";
  for (const std::string& step : steps) {
    text += "  " + step + "\n";
  }
  return {.json = {{"validate", steps}}, .text = text};
}

/// A line on one design; its plan is added where it can be made: a run is not lost by this.
std::string planned_line(const std::string& design, const PlanRunOptions& options, Json& plans) {
  const std::filesystem::path scene = options.run / design / "scene.toml";
  if (!std::filesystem::exists(scene)) {
    return fmt::format("{}: not planned: the run has no such design\n", design);
  }
  try {
    Json plan = plan_study(load_study(scene, {}), options);
    std::string line = fmt::format("{}: {}\n", design, plan_sentence(plan));
    plan["design"] = design;
    plans.push_back(std::move(plan));
    return line;
  } catch (const Error& error) {
    return fmt::format("{}: not planned: {}\n", design, error.what());
  }
}

/// What was typed of how the arm is to be driven, each with a space before it.
std::string driving_text(const AcquireArguments& driven) {
  std::string text = fmt::format(" --speed_share {}", driven.speed_share);
  if (!driven.twin.empty()) {
    text += " --twin " + shell_word(driven.twin.string());
  }
  for (const std::string& light : driven.confirmed) {
    text += " --confirmed " + shell_word(light);
  }
  return text;
}

/// The cell's file as the study names it, though its views cannot be planned for it; else a word
/// that stands for it.
std::filesystem::path named_cell(const Study& study) {
  const bool is_named = study.scene.cell && !study.scene.cell->file.empty();
  return is_named ? study.scene.cell->file : std::filesystem::path("CELL.toml");
}

/// Each design that is to be tried out, as the run has it, planned for the cell. @return JSON:
/// plans
AcquireAnswer planned_end(const Study& study,
                          const std::filesystem::path& run,
                          const AcquireArguments& driven,
                          int threads) {
  const std::filesystem::path plans = std::filesystem::absolute(beside_run(run) / "plan");
  AcquireAnswer answer =
      told_steps(validation_steps(study, run, driven.cell, driving_text(driven)));
  answer.json["plans"] = Json::array();
  std::string text;
  for (const std::string& design : designs_to_validate(study)) {
    const PlanRunOptions options = {
        .cell = driven.cell, .out = plans / design, .run = run, .threads = threads};
    text += planned_line(design, options, answer.json["plans"]);
  }
  answer.text = text + answer.text;
  return answer;
}

/// The command that goes on without a search.
std::string validating(const std::filesystem::path& run, const AcquireArguments& driven) {
  return fmt::format("glint validate {} --cell {} --out {}{} --move",
                     shell_word(run.string()),
                     shell_word(driven.cell.string()),
                     shell_word(driven.out.string()),
                     driving_text(driven));
}

}  // namespace

std::filesystem::path planned_cell(const Study& study, const AcquireArguments& driven) {
  if (!driven.cell.empty() || !study.scene.cell || study.scene.cell->file.empty()) {
    return driven.cell;
  }
  const std::filesystem::path& file = study.scene.cell->file;
  return has_cell_chain(study.scene, read_cell(file)) ? file : std::filesystem::path();
}

AcquireAnswer end_of_run(const Study& study,
                         const std::filesystem::path& run,
                         const AcquireArguments& driven,
                         int threads,
                         Progress::Style progress) {
  if (!driven.is_move) {
    return driven.cell.empty()
               ? told_steps(validation_steps(study, run, named_cell(study), driving_text(driven)))
               : planned_end(study, run, driven, threads);
  }
  AcquireArguments on_robot = driven;
  on_robot.out = std::filesystem::absolute(beside_run(run) / "validate");
  AcquireAnswer answer = run_validation(
      {.acquire = on_robot, .run = run, .threads = threads, .again = validating(run, on_robot)},
      progress);
  answer.json = {{"validation", std::move(answer.json)}};
  return answer;
}

AcquireAnswer run_validation(const ValidationArguments& arguments, Progress::Style progress) {
  if (!arguments.acquire.cell.empty()) {
    return validate_with_robot(arguments, progress);
  }
  if (arguments.pictures.empty()) {
    throw ConfigError(
        "glint validate: needs --pictures with real pictures, or --cell with the cell that takes "
        "them");
  }
  return answer_of(validate_run(options_of(arguments, progress)));
}

}  // namespace glint

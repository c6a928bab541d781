// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verbs that judge the program itself: frontier and stability.
#include "cli/frontier.h"

#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/frontier/frontier_page.h"
#include "studies/frontier/inspector_page.h"
#include "studies/frontier/search_page.h"
#include "studies/output/result_folder.h"
#include "studies/output/run_folder.h"
#include "studies/stability/stability_page.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string number_text(const Json& value, double factor, const char* none) {
  return value.is_number() ? fmt::format("{:.3g}", factor * value.get<double>()) : none;
}

std::string row_text(const Json& point) {
  const auto label = point["label"].get<std::string>();
  if (point.contains("problem")) {
    return fmt::format("  {:<44} {}\n", label, point["problem"].get<std::string>());
  }
  const bool is_on_front = !point["on_front"].empty();
  const char* mark = point["is_current"].get<bool>()  ? ">"
                     : point["is_choice"].get<bool>() ? "+"
                                                      : " ";
  return fmt::format("{}{}{:<44} {:>9} {:>8} {:>11} {:>9} {:>9} {:>11}\n",
                     is_on_front ? "*" : " ",
                     mark,
                     label,
                     number_text(point["cpu_s"], 1e3, "-"),
                     number_text(point["cold_s"], 1.0, "-"),
                     number_text(point["frame_rmse"], 1.0, "-"),
                     number_text(point["smooth_frame_rmse"], 1.0, "-"),
                     number_text(point["h_error_points"], 1.0, "-"),
                     number_text(point["contrast_error_percent"], 1.0, "-"));
}

std::string table_text(const Json& result) {
  std::string text = fmt::format("  {:<44} {:>9} {:>8} {:>11} {:>9} {:>9} {:>11}\n",
                                 "",
                                 "ms",
                                 "cold s",
                                 "frame rmse",
                                 "smooth",
                                 "h points",
                                 "contrast %");
  for (const Json& point : result["points"]) {
    text += row_text(point);
  }
  return text;
}

std::string ranking_text(const Json& result) {
  const Json& ranking = result["ranking"];
  if (ranking.is_null()) {
    return "";
  }
  std::string text = fmt::format("order of {} designs by {}, against {}:\n",
                                 ranking["designs"].get<int>(),
                                 ranking["score"].get<std::string>(),
                                 ranking["reference"].get<std::string>());
  for (const Json& row : ranking["methods"]) {
    const bool is_other = row["score"] != ranking["score"];
    text += fmt::format("  {:<44} {:>9} ms   tau {:>6.2f} of {} pairs   {}{}\n",
                        row["label"].get<std::string>(),
                        number_text(row["cpu_s"], 1e3, "-"),
                        row["tau"].get<double>(),
                        row["pairs"].get<int>(),
                        row["is_right"].get<bool>() ? "right" : "not shown to be right",
                        is_other ? ", by " + row["score"].get<std::string>() : "");
  }
  return text;
}

std::string inspector_text(const Json& result) {
  std::string text =
      fmt::format("  {:<44} {:>9} {:>9} {:>9} {:>9}\n", "", "ms", "looked at", "found", "false");
  for (const Json& point : result["points"]) {
    if (point.contains("problem")) {
      text += fmt::format(
          "  {:<44} {}\n", point["label"].get<std::string>(), point["problem"].get<std::string>());
      continue;
    }
    const Json& best = point["best"];
    const auto value = [&](const char* name) {
      return best.is_null() ? Json() : best[name]["value"];
    };
    text += fmt::format("{}{}{:<44} {:>9} {:>9} {:>9} {:>9}\n",
                        point["on_front"].get<bool>() ? "*" : " ",
                        point["is_current"].get<bool>() ? ">" : " ",
                        point["label"].get<std::string>(),
                        number_text(point["cpu_s"], 1e3, "-"),
                        number_text(point["region_share"], 1.0, "-"),
                        number_text(value("detected"), 1.0, "-"),
                        number_text(value("false_reports"), 1.0, "-"));
  }
  return text + fmt::format("found at no more than {:g} false reports a picture\n",
                            result["allowed_false_reports"].get<double>());
}

std::string searches_text(const Json& result) {
  std::string text;
  for (const Json& method : result["methods"]) {
    text += method["method"].get<std::string>() + ":\n";
    if (method.contains("problem")) {
      text += "  " + method["problem"].get<std::string>() + "\n";
    }
    for (const Json& row : method["summary"]) {
      text += fmt::format("  {:>7} evaluations  {:>10}  ({} to {}), {} of {} feasible\n",
                          row["evaluations"].get<int>(),
                          number_text(row["median"], 1.0, "-"),
                          number_text(row["low"], 1.0, "-"),
                          number_text(row["high"], 1.0, "-"),
                          row["feasible"].get<int>(),
                          row["runs"].get<int>());
    }
  }
  return text;
}

void print_chart(const CommonArguments& common, const Json& result, const std::string& table) {
  print_result(common,
               result,
               fmt::format("{}{}\nreport: {}\n",
                           table,
                           result["sentence"].get<std::string>(),
                           result["report"].get<std::string>()));
}

int list_sweeps(const std::vector<stability::Sweep>& sweeps, const CommonArguments& common) {
  Json list = Json::array();
  std::string text;
  for (const stability::Sweep& sweep : sweeps) {
    list.push_back({{"name", sweep.name},
                    {"swept", sweep.swept},
                    {"title", sweep.title},
                    {"cells", sweep.values.size()}});
    text += fmt::format("{:<24} {}\n", sweep.name, sweep.title);
  }
  print_result(common, Json{{"sweeps", list}}, text);
  return kExitDone;
}

std::string cell_text(const Json& cell) {
  const std::string error =
      cell["error"].is_number()
          ? fmt::format(
                "{:.3g} {}", cell["error"].get<double>(), cell["quantity"].get<std::string>())
          : "-";
  std::string message = cell["message"].get<std::string>();
  message = message.substr(0, message.find('\n'));
  return fmt::format("    {:<10} {:<26} {:<15} {}\n",
                     fmt::format("{:.4g}", cell["value"].get<double>()),
                     error,
                     cell["verdict"].get<std::string>(),
                     message);
}

std::string sweeps_text(const Json& result) {
  std::string text;
  for (const Json& sweep : result["sweeps"]) {
    text += fmt::format(
        "{}: {}\n", sweep["name"].get<std::string>(), sweep["title"].get<std::string>());
    for (const Json& cell : sweep["cells"]) {
      text += cell_text(cell);
    }
  }
  const Json& totals = result["totals"];
  return text + fmt::format(
                    "{} right, {} wrong and told, {} refused, {} silently wrong, {} left out\n"
                    "report: {}\n",
                    totals["right"].get<int>(),
                    totals["told"].get<int>(),
                    totals["refused"].get<int>(),
                    totals["silently_wrong"].get<int>(),
                    totals["left_out"].get<int>(),
                    result["report"].get<std::string>());
}

/// What does not depend on what is swept.
stability::StabilityRun stability_run(const StabilityArguments& arguments,
                                      const CommonArguments& common) {
  stability::StabilityRun run{
      .out = arguments.study.out.empty() ? "out/stability" : arguments.study.out,
      .threads = common.threads,
      .bounds = {arguments.h_points, arguments.contrast_percent, arguments.picture},
      .progress = common.progress()};
  if (arguments.budget_min > 0.0) {
    run.budget_s = 60.0 * arguments.budget_min;
  }
  return run;
}

/// Of a finished run.
int winner_command(const StabilityArguments& arguments, const CommonArguments& common) {
  const bool has_more = !arguments.study.study.empty() || !arguments.sweeps.empty() ||
                        arguments.is_list || !arguments.study.sets.empty();
  if (has_more) {
    throw ConfigError("--run: stands alone, without STUDY.toml, --set, --sweep and --list");
  }
  stability::StabilityRun run = stability_run(arguments, common);
  const std::string study = study_of_folder(arguments.run);
  if (arguments.study.out.empty() && !study.empty()) {
    run.out = default_result_folder(study, ResultKind::kStability);
    run.out.replace_filename("stability_winner");  // that of the sweeps is another one
    check_source_of_folder(run.out, {arguments.run / kRunStudy});
  }
  const Json result = stability::winner_study(arguments.run, run);
  print_result(common, result, sweeps_text(result));
  return result["totals"]["silently_wrong"].get<int>() == 0 ? kExitDone : kExitNegative;
}

int sweeps_command(const StabilityArguments& arguments, const CommonArguments& common) {
  std::optional<Study> study;
  if (!arguments.study.study.empty()) {
    study = load_study(arguments.study);
  } else if (!arguments.study.sets.empty()) {
    throw ConfigError("--set: needs a STUDY.toml whose keys it sets");
  }
  const auto sweeps = stability::chosen_sweeps(
      arguments.sweeps, study ? stability::swept_scene(study->scene) : stability::SweptScene());
  if (arguments.is_list) {
    return list_sweeps(sweeps, common);
  }
  stability::StabilityRun run = stability_run(arguments, common);
  if (study) {
    run.out = out_folder(arguments.study, *study, ResultKind::kStability);
  }
  const Json result = stability::stability_study(study ? &*study : nullptr, sweeps, run);
  print_result(common, result, sweeps_text(result));
  return result["totals"]["silently_wrong"].get<int>() == 0 ? kExitDone : kExitNegative;
}

}  // namespace

int frontier_command(const StudyArguments& arguments, const CommonArguments& common) {
  const Study study = load_study(arguments);
  FrontierRun run = {.out = out_folder(arguments, study, ResultKind::kFrontier),
                     .threads = common.threads,
                     .progress = common.progress()};
  if (!arguments.budget.empty()) {
    run.budget_s = study.budget.wall_clock_s;
  }
  const Json result = frontier_study(study, run);
  print_result(common,
               result,
               fmt::format("{}* nothing cheaper has a smaller error of one of the three kinds\n"
                           "> the scene's own setting, + the program's own choice\n"
                           "{}report: {}\ndrawing: {}\n",
                           table_text(result),
                           ranking_text(result),
                           result["report"].get<std::string>(),
                           result["drawing"].get<std::string>()));
  return kExitDone;
}

int frontier_chart_command(const StudyArguments& arguments,
                           const FrontierArguments& chart,
                           const CommonArguments& common) {
  if (!chart.is_inspector && !chart.is_search) {
    return frontier_command(arguments, common);
  }
  const Study study = load_study(arguments);
  FrontierRun run = {.out = out_folder(arguments, study, ResultKind::kFrontier),
                     .threads = common.threads,
                     .progress = common.progress()};
  if (!arguments.budget.empty()) {
    run.budget_s = study.budget.wall_clock_s;
  }
  if (chart.is_inspector) {
    const Json result = inspector_study(study, run);
    print_chart(common, result, inspector_text(result));
  } else {
    const Json result = searches_study(study, run, chart.methods, chart.seeds);
    print_chart(common, result, searches_text(result));
  }
  return kExitDone;
}

int stability_command(const StabilityArguments& arguments, const CommonArguments& common) {
  return arguments.run.empty() ? sweeps_command(arguments, common)
                               : winner_command(arguments, common);
}

}  // namespace glint

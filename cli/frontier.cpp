// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verbs that judge the program itself: frontier and stability.
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "studies/frontier/frontier_page.h"
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
  const bool is_current = point["is_current"];
  return fmt::format("{}{}{:<44} {:>9} {:>8} {:>11} {:>9} {:>9} {:>11}\n",
                     is_on_front ? "*" : " ",
                     is_current ? ">" : " ",
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
    text += fmt::format("  {:<44} {:>9} ms   tau {:>6.2f} of {} pairs   {}\n",
                        row["label"].get<std::string>(),
                        number_text(row["cpu_s"], 1e3, "-"),
                        row["tau"].get<double>(),
                        row["pairs"].get<int>(),
                        row["is_right"].get<bool>() ? "right" : "not shown to be right");
  }
  return text;
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
                           "> the scene's own setting\n"
                           "{}report: {}\ndrawing: {}\n",
                           table_text(result),
                           ranking_text(result),
                           result["report"].get<std::string>(),
                           result["drawing"].get<std::string>()));
  return kExitDone;
}

int stability_command(const StabilityArguments& arguments, const CommonArguments& common) {
  const auto sweeps = stability::chosen_sweeps(arguments.sweeps);
  if (arguments.is_list) {
    return list_sweeps(sweeps, common);
  }
  std::optional<Study> study;
  if (!arguments.study.study.empty()) {
    study = load_study(arguments.study);
  } else if (!arguments.study.sets.empty()) {
    throw ConfigError("--set: needs a STUDY.toml whose keys it sets");
  }
  stability::StabilityRun run{
      .out =
          study ? out_folder(arguments.study, *study, ResultKind::kStability) : arguments.study.out,
      .threads = common.threads,
      .bounds = {arguments.h_points, arguments.contrast_percent, arguments.picture},
      .progress = common.progress()};
  if (run.out.empty()) {
    run.out = "out/stability";
  }
  if (arguments.budget_min > 0.0) {
    run.budget_s = 60.0 * arguments.budget_min;
  }
  const Json result = stability::stability_study(study ? &*study : nullptr, sweeps, run);
  print_result(common, result, sweeps_text(result));
  return result["totals"]["silently_wrong"].get<int>() == 0 ? kExitDone : kExitNegative;
}

}  // namespace glint

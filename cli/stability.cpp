// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "studies/stability/stability_page.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

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

std::string table_text(const Json& result) {
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
  print_result(common, result, table_text(result));
  return result["totals"]["silently_wrong"].get<int>() == 0 ? kExitDone : kExitNegative;
}

}  // namespace glint

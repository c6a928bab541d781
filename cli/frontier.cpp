// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "studies/frontier/frontier_page.h"

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
  return fmt::format("{} {:<44} {:>9} {:>8} {:>11} {:>9} {:>9} {:>11}\n",
                     is_on_front ? "*" : " ",
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

}  // namespace

int frontier_command(const StudyArguments& arguments, const CommonArguments& common) {
  const Study study = load_study(arguments);
  const Json result = frontier_study(study,
                                     {.out = out_folder(arguments, study, ResultKind::kFrontier),
                                      .threads = common.threads,
                                      .progress = common.progress()});
  print_result(common,
               result,
               fmt::format("{}* nothing cheaper has a smaller error of one of the three kinds\n"
                           "report: {}\ndrawing: {}\n",
                           table_text(result),
                           result["report"].get<std::string>(),
                           result["drawing"].get<std::string>()));
  return kExitDone;
}

}  // namespace glint

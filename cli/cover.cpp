// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "studies/cover/cover_run.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

double percent(const Json& share) {
  return 100.0 * share.get<double>();
}

std::string views_text(const Json& views) {
  std::string text =
      fmt::format("  {:<12} {:>9} {:>9} {:>9}\n", "view", "sees %", "adds %", "only %");
  for (const Json& view : views) {
    text += fmt::format("  {:<12} {:>9.2f} {:>9.2f} {:>9.2f}\n",
                        view["name"].get<std::string>(),
                        percent(view["sees"]),
                        percent(view["adds"]),
                        percent(view["only"]));
  }
  return text;
}

std::string states_text(const Json& states) {
  std::string text;
  for (const auto& [name, share] : states.items()) {
    if (name != "inspected" && share.get<double>() > 0.0) {
      text += fmt::format("{}{} {:.2f} %", text.empty() ? "" : ", ", name, percent(share));
    }
  }
  return text.empty() ? text : "not inspected: " + text + "\n";
}

std::string coverage_text(const Json& result) {
  std::string text = views_text(result["views"]);
  for (std::size_t k = 0; k < result["ck"].size(); ++k) {
    text += fmt::format("{}C{} {:.2f} %", k == 0 ? "" : "  ", k + 1, percent(result["ck"][k]));
  }
  text += fmt::format("; {:.2f} views a place\n", result["redundancy"].get<double>());
  text += states_text(result["states"]);
  if (const Json& gap = result["largest_gap"]; !gap.is_null()) {
    text += fmt::format(
        "largest gap: {:.4g} mm2 at ({:.1f}, {:.1f}, {:.1f}) mm, {:.3g} mm across, mostly {}\n",
        gap["area_mm2"].get<double>(),
        gap["place_mm"][0].get<double>(),
        gap["place_mm"][1].get<double>(),
        gap["place_mm"][2].get<double>(),
        gap["size_mm"].get<double>(),
        gap["mostly"].get<std::string>());
  }
  if (const Json& smallest = result["smallest_defect"]; !smallest.is_null()) {
    text += fmt::format(
        "smallest defect: {:.3g} um on half of what is inspected, {:.3g} um on 95 % of it\n",
        smallest["median_um"].get<double>(),
        smallest["p95_um"].get<double>());
  }
  return text + fmt::format("report: {}\n", result["report"].get<std::string>());
}

}  // namespace

int cover_command(const CoverArguments& arguments, const CommonArguments& common) {
  const Study study = load_study(arguments.study, SceneUse::kCoverage);
  const Json result = cover_study(study,
                                  {.out = out_folder(arguments.study, study, ResultKind::kCover),
                                   .pod = arguments.pod,
                                   .threads = common.threads,
                                   .progress = common.progress()});
  print_result(common, result, coverage_text(result));
  return kExitDone;
}

}  // namespace glint

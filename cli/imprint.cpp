// SPDX-License-Identifier: GPL-3.0-or-later

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/shell/counted.h"
#include "cli/shell/interrupts.h"
#include "cli/shell/note_lines.h"
#include "studies/imprint/imprint_run.h"
#include "studies/imprint/imprint_tools.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string size_text(const Json& defect) {
  const std::string opening = defect.contains("length_mm")
                                  ? fmt::format("{:.3g} x {:.3g}",
                                                defect["length_mm"].get<double>(),
                                                defect["width_mm"].get<double>())
                                  : fmt::format("{:.3g}", defect["diameter_mm"].get<double>());
  return fmt::format("{:>14} {:>9.4g}", opening, defect["depth_um"].get<double>());
}

std::string defects_text(const Json& result) {
  std::string text = fmt::format("  {:<20} {:<10} {:>14} {:>9} {:>12} {:>8}\n",
                                 "",
                                 "",
                                 "opening mm",
                                 "depth um",
                                 "removed mm3",
                                 "retries");
  for (const Json& defect : result["defects"]) {
    text += fmt::format("  {:<20} {:<10} {} {:>12.4g} {:>8}",
                        defect["label"].get<std::string>(),
                        defect["realisation"].get<std::string>(),
                        size_text(defect),
                        defect["removed_volume_mm3"].get<double>(),
                        defect["attempts"].get<int>() - 1);
    if (const auto reason = defect.value("reason", ""); !reason.empty()) {
      text += "  given up: " + reason;
    }
    text += "\n";
  }
  return text;
}

std::string totals_text(const Json& result) {
  const int retries = result["retries"].get<int>();
  return fmt::format("{} made, {} given up, {} {}, {:.6g} mm3 removed\n",
                     counted(result["made"].get<std::size_t>(), "defect"),
                     result["given_up"].get<int>(),
                     retries,
                     retries == 1 ? "retry" : "retries",
                     result["removed_volume_mm3"].get<double>());
}

bool is_interrupted(const Json& result) {
  return result["status"] == "interrupted";
}

std::string one_text(const Json& result) {
  if (is_interrupted(result)) {
    return "interrupted\n";
  }
  return defects_text(result) + totals_text(result) + note_lines(result["notes"]) +
         fmt::format("files: {}\n", result["folder"].get<std::string>());
}

std::string many_text(const Json& result) {
  std::string text = fmt::format("{}: {} of {} parts\n",
                                 result["status"].get<std::string>(),
                                 result["parts"].size(),
                                 result["count"].get<int>());
  text += totals_text(result) + note_lines(result["notes"]);
  return text + fmt::format("files: {}\n", result["folder"].get<std::string>());
}

std::string tools_text(const Json& result) {
  std::string text;
  for (const Json& tool : result["tools"]) {
    text += fmt::format("  {:<28} {:>7} triangles {:>10.4g} mm3\n",
                        tool["name"].get<std::string>(),
                        tool["triangles"].get<int>(),
                        tool["volume_mm3"].get<double>());
  }
  return text + fmt::format("drawing: {}/tools.png\n", result["folder"].get<std::string>());
}

}  // namespace

int imprint_command(const ImprintArguments& arguments, const CommonArguments& common) {
  StudyArguments source = arguments.study;
  if (source.seed) {
    source.sets.push_back(fmt::format("imprint.seed={}", *source.seed));
    source.seed.reset();
  }
  const Study study = load_study(source);
  const ResultKind kind = arguments.is_preview_of_tools ? ResultKind::kTools : ResultKind::kImprint;
  ImprintOptions options = {.out = out_folder(source, study, kind),
                            .count = arguments.count,
                            .threads = common.threads,
                            .has_previews = !arguments.is_without_previews,
                            .progress = common.progress()};
  if (arguments.is_preview_of_tools) {
    const Json result = preview_tools(study, options);
    print_result(common, result, tools_text(result));
    return kExitDone;
  }
  options.interrupt = &take_interrupts();
  const Json result = imprint_scene(study, options);
  print_result(common, result, arguments.count > 0 ? many_text(result) : one_text(result));
  return is_interrupted(result) ? kExitInterrupted : kExitDone;
}

}  // namespace glint

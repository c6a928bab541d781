// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/shell/counted.h"
#include "cli/shell/interrupts.h"
#include "studies/inspect/inspect_folder.h"
#include "studies/inspect/inspect_run.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxLines = 40;  ///< of the table of parts

/// Columns of the table of parts.
constexpr const char* kRow = "  {:<24} {:<10} {:>6} {:>12} {:>12} {:>10} {:>12} {:>12} {:>10}";

std::string size_text(const Json& size, const std::string& unit) {
  return fmt::format("{:.{}f} {}", size.get<double>(), unit == "px" ? 0 : 3, unit);
}

std::string part_text(const Json& part, const std::string& unit) {
  std::string text =
      fmt::format(kRow,
                  part["name"].get<std::string>(),
                  part["grade"].is_null() ? "" : part["grade"].get<std::string>(),
                  part["holes"]["count"].get<int>(),
                  size_text(part["holes"]["biggest"], unit),
                  size_text(part["holes"]["sum"], unit),
                  part["scratches"]["count"].get<int>(),
                  size_text(part["scratches"]["biggest"], unit),
                  size_text(part["scratches"]["sum"], unit),
                  fmt::format("{:.1f} %", 100.0 * part["bright_share"].get<double>()));
  if (part.contains("truth")) {
    const Json& truth = part["truth"];
    text += fmt::format("  {} of {} found, {}",
                        truth["found"].get<int>(),
                        truth["defects"].get<int>(),
                        counted(truth["false_alarms"].get<std::size_t>(), "false alarm"));
  }
  return text + "\n";
}

/// Each note once, with the part or the number of parts it holds for.
std::string notes_text(const Json& parts) {
  std::vector<std::pair<std::string, std::vector<std::string>>> notes;  // names by note
  for (const Json& part : parts) {
    for (const Json& note : part["notes"]) {
      const std::string text = note.get<std::string>();
      auto at = std::ranges::find_if(notes, [&](const auto& known) { return known.first == text; });
      if (at == notes.end()) {
        at = notes.insert(at, {text, {}});
      }
      at->second.push_back(part["name"].get<std::string>());
    }
  }
  std::string text;
  for (const auto& [note, names] : notes) {
    text += fmt::format("note: {}: {}\n",
                        names.size() == 1 ? names.front() : fmt::format("{} parts", names.size()),
                        note);
  }
  return text;
}

std::string result_text(const Json& result) {
  const Json& parts = result["parts"];
  const auto unit = result["unit"].get<std::string>();
  std::string text = fmt::format(kRow,
                                 "part",
                                 "grade",
                                 "holes",
                                 "biggest",
                                 "sum",
                                 "scratches",
                                 "biggest",
                                 "sum",
                                 "inspected") +
                     "\n";
  for (std::size_t i = 0; i < std::min(parts.size(), kMaxLines); ++i) {
    text += part_text(parts[i], unit);
  }
  if (parts.size() > kMaxLines) {
    text += fmt::format("  ... and {} more\n", parts.size() - kMaxLines);
  } else {
    text += notes_text(parts);
  }
  text += "holes: also bumps; inspected: share of what is bright in the picture\n";
  if (result["has_limits"].get<bool>()) {
    const Json& grades = result["grades"];
    text += fmt::format("{} perfect, {} acceptable, {} rejected\n",
                        grades["Perfect"].get<int>(),
                        grades["Acceptable"].get<int>(),
                        grades["Rejected"].get<int>());
  } else {
    text += "not graded: no limits of the classes are set\n";
  }
  if (result.contains("learned")) {
    text += fmt::format("limits learned from {} parts, {} of them in another class: {}/{}\n",
                        result["learned"]["parts"].get<int>(),
                        result["learned"]["wrong"].get<int>(),
                        result["folder"].get<std::string>(),
                        result["learned"]["file"].get<std::string>());
  }
  return text + fmt::format("report: {}\n", result["report"].get<std::string>());
}

bool is_negative(const Json& result) {
  return !result.contains("learned") && result["has_limits"].get<bool>() &&
         result["grades"]["Rejected"].get<int>() > 0;
}

std::filesystem::path inspect_folder(const InspectArguments& arguments) {
  if (!arguments.out.empty()) {
    return arguments.out;
  }
  std::filesystem::path folder = default_inspect_folder(arguments.inputs);
  check_source_of_folder(folder, {source_of_inspection(arguments.inputs)});
  return folder;
}

}  // namespace

int inspect_command(const InspectArguments& arguments, const CommonArguments& common) {
  const InspectOptions options = {.inputs = arguments.inputs,
                                  .out = inspect_folder(arguments),
                                  .is_each = arguments.is_each,
                                  .mask = arguments.mask,
                                  .reference_mask = arguments.reference_mask,
                                  .settings = arguments.settings,
                                  .sets = key_values(arguments.sets),
                                  .flawless = arguments.flawless,
                                  .labels = arguments.labels,
                                  .is_learning = arguments.is_learning,
                                  .threads = common.threads,
                                  .progress = common.progress(),
                                  .interrupt = &take_interrupts()};
  const Json result = inspect_parts(options);
  if (result["status"] == "interrupted") {
    print_result(common, result, "interrupted\n");
    return kExitInterrupted;
  }
  print_result(common, result, result_text(result));
  return is_negative(result) ? kExitNegative : kExitDone;
}

}  // namespace glint

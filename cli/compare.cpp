// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/shell/note_lines.h"
#include "studies/compare/compare_run.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// A number, or a dash where there is none.
std::string cell(const Json& value, int digits) {
  return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), digits) : std::string("-");
}

constexpr const char* kCompareRow = "  {:<20} {:<20} {:>8} {:>9} {:>8} {:>9} {:>7} {:>10}\n";

constexpr std::size_t kEdgeRows = 12;  ///< the longest; result.json has more

/// What the table of edges does not show.
std::string unlisted_text(const Json& pair) {
  const std::size_t count = pair["edges"].size();
  const Json& unlisted = pair["unlisted_edges"];
  std::string text;
  if (count > kEdgeRows && pair["edges"][0].contains("surface")) {
    text += fmt::format("    {} shorter ones are in result.json\n", count - kEdgeRows);
  }
  const double share = unlisted["outline_share"].get<double>();
  const auto further = unlisted["count"].get<std::size_t>();
  if (further > 0 || share >= 5e-4) {
    text += fmt::format("    not listed: {} further edge{}; {:.1f} % of the outline\n",
                        further,
                        further == 1 ? "" : "s",
                        100.0 * share);
  }
  return text;
}

/// Edges of the part, where they have names.
std::string edges_text(const Json& pair) {
  const Json& edges = pair["edges"];
  if (edges.empty() || !edges[0].contains("surface")) {
    return unlisted_text(pair);
  }
  std::string text = fmt::format("    {:>9} {:>8} {:>9} {:>8} {:>9}  edge of the part\n",
                                 "length mm",
                                 "mean px",
                                 "offset px",
                                 "sigma px",
                                 "offset mm");
  for (std::size_t i = 0; i < std::min(edges.size(), kEdgeRows); ++i) {
    const Json& edge = edges[i];
    const auto surface = edge["surface"].get<std::string>();
    const auto beyond = edge["beyond"].get<std::string>();
    text += fmt::format("    {:>9} {:>8} {:>9} {:>8} {:>9}  {}{}\n",
                        cell(edge["length_mm"], 1),
                        cell(edge["mean_px"], 3),
                        cell(edge["offset_px"], 3),
                        cell(edge["sigma_px"], 3),
                        cell(edge["offset_mm"], 4),
                        edge["name"].get<std::string>(),
                        surface == beyond ? fmt::format(" on {}", surface)
                                          : fmt::format(": {} | {}", surface, beyond));
  }
  return text + unlisted_text(pair);
}

std::string comparison_text(const Json& result) {
  std::string text = fmt::format(kCompareRow,
                                 "simulated",
                                 "real",
                                 "IoU",
                                 "mean px",
                                 "HD95 px",
                                 "offset px",
                                 "SSIM",
                                 "histogram");
  for (const Json& pair : result["pairs"]) {
    text += fmt::format(kCompareRow,
                        pair["simulated"].get<std::string>(),
                        pair["real"].get<std::string>(),
                        cell(pair["iou"], 4),
                        cell(pair["mean_distance_px"], 3),
                        cell(pair["hd95_px"], 3),
                        cell(pair["offset_px"], 3),
                        cell(pair["ssim"], 3),
                        cell(pair["histogram_distance"], 4));
    for (const Json& cause : pair["causes"]) {
      text += fmt::format("    {:<24} {:>10} +- {} {}  explains {} %\n",
                          cause["name"].get<std::string>(),
                          cell(cause["value"], 4),
                          cell(cause["sigma"], 4),
                          cause["unit"].get<std::string>(),
                          cell(Json(100.0 * cause["share"].get<double>()), 0));
    }
    text += edges_text(pair);
    for (const Json& note : pair["notes"]) {
      text += "    note: " + note.get<std::string>() + "\n";
    }
  }
  return text + note_lines(result["notes"]) +
         fmt::format("{}\nreport: {}\n",
                     result["verdict"].get<std::string>(),
                     result["report"].get<std::string>());
}

}  // namespace

int compare_command(const CompareArguments& arguments, const CommonArguments& common) {
  if (arguments.pictures.size() < 2) {
    throw ConfigError("compare needs a simulated picture and at least one real one");
  }
  const Json result = compare_pictures(
      {.inputs = {.simulated = arguments.pictures.front(),
                  .reals = {arguments.pictures.begin() + 1, arguments.pictures.end()},
                  .pairs = arguments.pairs},
       .out = arguments.out,
       .mask = arguments.mask,
       .scene = arguments.scene,
       .outline = arguments.outline,
       .has_offset = arguments.has_offset,
       .is_lens_known = arguments.is_lens_known,
       .calibration = arguments.calibration,
       .has_roughness = arguments.has_roughness,
       .is_refining = arguments.is_refining,
       .threads = common.threads,
       .progress = common.progress()});
  print_result(common, result, comparison_text(result));
  return kExitDone;
}

}  // namespace glint

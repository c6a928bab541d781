// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_page.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/inspection_line/inspection_json.h"
#include "studies/output/provenance.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPictureWidthPx = 1300;
constexpr std::size_t kMaxDefects = 600;  ///< of one part on the page; the CSV file has all

std::string plural(std::int64_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string sentence(const Json& result, std::span<const InspectedPart> parts) {
  std::int64_t defects = 0;
  for (const InspectedPart& part : parts) {
    defects += static_cast<std::int64_t>(part.inspection.defects.size());
  }
  std::string text = fmt::format("{} found on {}",
                                 defects == 0 ? "No defect was" : plural(defects, "defect"),
                                 plural(static_cast<std::int64_t>(parts.size()), "part"));
  if (result["has_limits"].get<bool>()) {
    const Json& grades = result["grades"];
    text += fmt::format(": {} perfect, {} acceptable, {} rejected",
                        grades["Perfect"].get<int>(),
                        grades["Acceptable"].get<int>(),
                        grades["Rejected"].get<int>());
  }
  text += ".";
  if (result.contains("truth")) {
    const Json& truth = result["truth"];
    text += fmt::format(" Of {} known to be there, {} were found and {} missed; {}.",
                        plural(truth["defects"].get<int>(), "defect"),
                        truth["found"].get<int>(),
                        truth["missed"].get<int>(),
                        plural(truth["false_alarms"].get<int>(), "false alarm"));
  }
  return text;
}

std::vector<std::string> details(const Json& result) {
  std::vector<std::string> lines;
  if (!result["has_limits"].get<bool>()) {
    lines.emplace_back(
        "No limits of the classes are set, so parts are not graded: set inspection.holes and "
        "inspection.scratches, or learn them from graded parts with --labels and --learn.");
  }
  if (result.contains("learned")) {
    lines.push_back(
        fmt::format("The limits were learned from {}, of which {} fell into another "
                    "class than their label says.",
                    plural(result["learned"]["parts"].get<int>(), "graded part"),
                    result["learned"]["wrong"].get<int>()));
  } else if (result.contains("agreement")) {
    lines.push_back(fmt::format("{} of {} have the grade that their label says.",
                                result["agreement"]["equal"].get<int>(),
                                plural(result["agreement"]["parts"].get<int>(), "labelled part")));
  }
  return lines;
}

/// Numbers of the biggest defects, the biggest first.
std::vector<std::size_t> biggest_of(const std::vector<FoundDefect>& defects) {
  std::vector<std::size_t> order(defects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return defects[a].area_px > defects[b].area_px; });
  order.resize(std::min(order.size(), kMaxDefects));
  return order;
}

std::string known_as(const InspectedPart& part, std::size_t blob) {
  const int known = part.comparison->defect_of_blob[blob];
  if (known < 0) {
    return "false alarm";
  }
  const auto i = static_cast<std::size_t>(known);
  return part.known[i].label +
         (part.comparison->blob_of_defect[i] == static_cast<int>(blob) ? "" : " (beside it)");
}

/// Corners as an SVG polygon has them.
std::string outline_text(const DefectMark& mark) {
  std::string text;
  for (const Eigen::Vector2d& corner : mark.outline) {
    text += fmt::format("{}{:.1f},{:.1f}", text.empty() ? "" : " ", corner.x(), corner.y());
  }
  return text;
}

/// Adds to a part of result.json what the page shows of it, and keeps its biggest defects.
void add_picture(const InspectedPart& part, const std::string& picture, Json& json) {
  const std::vector<DefectMark> marks = marks_of(part.inspection.defects);
  Json defects = Json::array();
  for (const std::size_t i : biggest_of(part.inspection.defects)) {
    Json& defect = defects.emplace_back(json["defects"][i]);
    defect["outline"] = outline_text(marks[i]);
    if (part.comparison) {
      defect["known_as"] = known_as(part, i);
    }
  }
  json["defects"] = std::move(defects);
  json["missed"] = Json::array();
  if (part.comparison) {
    for (const DefectMark& mark : missed_marks(part.known, *part.comparison)) {
      json["missed"].push_back(
          {{"label", part.known[static_cast<std::size_t>(mark.number - 1)].label},
           {"outline", outline_text(mark)}});
    }
  }
  json["histogram"] = {{"reach", part.histogram.reach}, {"counts", part.histogram.counts}};
  json["image"] = picture;
}

/// On which sides of its background a defect may lie: 1 brighter, -1 darker.
Json sides_of(InspectionSettings::Polarity polarity) {
  using Polarity = InspectionSettings::Polarity;
  Json sides = Json::array();
  if (polarity != Polarity::kBright) {
    sides.push_back(-1);
  }
  if (polarity != Polarity::kDark) {
    sides.push_back(1);
  }
  return sides;
}

}  // namespace

std::string page_picture(const ImageF& shown) {
  return report_png(shown, kPictureWidthPx);
}

std::string inspect_page(const Json& result,
                         std::span<const InspectedPart> parts,
                         std::span<const std::string> pictures,
                         const InspectionSettings& settings,
                         const std::string& toml) {
  Json inspection = result;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Json& part = inspection["parts"][i];
    if (i < pictures.size()) {
      add_picture(parts[i], pictures[i], part);
    } else {
      part.erase("defects");
    }
  }
  inspection["sides"] = sides_of(settings.polarity);
  inspection["limits"] = {{"holes", limits_json(settings.holes)},
                          {"scratches", limits_json(settings.scratches)}};
  return render_report({{"title", "Inspection"},
                        {"verdict",
                         {{"title", "Summary"},
                          {"sentence", sentence(result, parts)},
                          {"tone", "neutral"},
                          {"details", details(result)}}},
                        {"inspection", inspection},
                        {"config_toml", toml},
                        {"provenance", provenance()}});
}

}  // namespace glint

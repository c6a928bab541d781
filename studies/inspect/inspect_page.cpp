// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_page.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/drawing/sizes_drawing.h"
#include "studies/inspect/inspect_html.h"
#include "studies/inspect/inspect_page_part.h"
#include "studies/output/provenance.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using inspect_html::badge;
using inspect_html::cell;
using inspect_html::heads;
using inspect_html::number;
using inspect_html::part_section;
using inspect_html::plural;

constexpr int kPictureWidthPx = 1300;

constexpr std::string_view kStyle = R"(
:root { --ink: #1d252c; --soft: #55606a; --line: #dde2e6; --blue: #0072b2; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1320px; padding: 0 32px 64px; color: var(--ink); background: #fff;
  font: 15px/1.5 "Inter", system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif;
  font-variant-numeric: tabular-nums; }
h1, h2, h3, p { margin: 0; }
h1 { font-size: 32px; line-height: 1.2; letter-spacing: -0.02em; overflow-wrap: anywhere; }
h2 { font-size: 21px; padding-top: 40px; }
h3 { font-size: 17px; padding-top: 30px; overflow-wrap: anywhere; }
.brand { padding-top: 36px; font-weight: 700; color: var(--blue); }
.sentence { font-size: 23px; line-height: 1.35; max-width: 46em; margin: 10px 0; }
.lead, .notes { color: var(--soft); max-width: 90ch; }
.notes { font-size: 14px; padding-left: 18px; margin: 6px 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 14px; margin-top: 10px; }
th { text-align: left; font-size: 13px; color: var(--soft); vertical-align: bottom; }
td, th { padding: 5px 16px 5px 0; border-bottom: 1px solid var(--line); }
td.n, th.n { text-align: right; }
.badge { display: inline-block; padding: 0 9px; border-radius: 10px; font-size: 12px;
  line-height: 20px; font-weight: 600; background: #eceff1; color: var(--soft); }
.Perfect { color: #00674b; background: #e0f2ec; }
.Acceptable { color: #7a5a00; background: #fbf1d5; }
.Rejected { color: #b84a00; background: #fbeade; }
.picture { width: 100%; height: auto; display: block; margin-top: 10px; background: #14181b; }
.side { display: flex; flex-wrap: wrap; gap: 8px 48px; align-items: flex-start; }
.key { display: inline-block; width: 22px; height: 11px; margin: 0 5px 0 16px; border: 2px solid; }
.key.hole, .key.missed { border-radius: 8px; }
.key.missed { border-style: dashed; }
pre { padding: 14px 16px; overflow-x: auto; background: #f5f7f8; border: 1px solid var(--line);
  font: 12.5px/1.5 ui-monospace, Menlo, Consolas, monospace; }
summary { cursor: pointer; color: var(--soft); font-size: 13px; margin-top: 12px; }
a { color: inherit; }
)";

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

std::vector<std::string> leads(const Json& result) {
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

std::string sizes_cells(const DefectSizes& sizes) {
  return cell(number(sizes.biggest)) + cell(number(sizes.sum));
}

std::string parts_table(std::span<const InspectedPart> parts,
                        bool has_truth,
                        std::size_t num_pictures) {
  std::string text = "<div class=\"scroll\"><table>\n<tr><th></th><th></th>";
  text += "<th colspan=\"2\">holes and bumps</th><th colspan=\"2\">scratches</th></tr>\n";
  text += has_truth ? heads({"!part",
                             "!grade",
                             "biggest",
                             "sum",
                             "biggest",
                             "sum",
                             "defects",
                             "threshold",
                             "noise",
                             "found",
                             "missed",
                             "false alarms"})
                    : heads({"!part",
                             "!grade",
                             "biggest",
                             "sum",
                             "biggest",
                             "sum",
                             "defects",
                             "threshold",
                             "noise"});
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const InspectedPart& part = parts[i];
    const std::string name = markup_text(part.source.name);
    const std::string link =
        i < num_pictures ? fmt::format("#part{}", i + 1) : fmt::format("{}/overlay.png", name);
    std::string grade = badge(part.grade);
    if (part.label && part.grade && *part.label != *part.grade) {
      grade += fmt::format(" label: {}", grade_name(*part.label));
    }
    text += "<tr>" + cell(fmt::format("<a href=\"{}\">{}</a>", link, name), false) +
            cell(grade, false) + sizes_cells(part.holes) + sizes_cells(part.scratches) +
            cell(fmt::format("{}", part.inspection.defects.size())) +
            cell(number(part.inspection.threshold)) + cell(number(part.inspection.noise));
    if (part.comparison) {
      const int found = part.comparison->found();
      text += cell(fmt::format("{}", found)) +
              cell(fmt::format("{}", static_cast<int>(part.known.size()) - found)) +
              cell(fmt::format("{}", part.comparison->false_alarms()));
    }
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string sizes_section(std::span<const InspectedPart> parts,
                          const InspectionSettings& settings,
                          bool is_learned) {
  const auto chart = [&](DefectKind kind) {
    const bool is_hole = kind == DefectKind::kHole;
    SizesChart sizes;
    sizes.title = is_hole ? "Holes and bumps" : "Scratches";
    sizes.unit = settings.measure == InspectionSettings::Measure::kArea ? "px" : "weight";
    sizes.limits = is_hole ? settings.holes : settings.scratches;
    for (const InspectedPart& part : parts) {
      sizes.points.push_back({.sizes = is_hole ? part.holes : part.scratches,
                              .expert = part.label ? *part.label : *part.grade,
                              .is_test = !is_learned || !part.label,
                              .is_wrong = part.label && *part.label != *part.grade});
    }
    return sizes_svg(sizes);
  };
  const bool all_labelled =
      std::ranges::all_of(parts, [](const InspectedPart& part) { return part.label.has_value(); });
  return std::string("<h2>Biggest defect and sum of all</h2>\n") +
         (all_labelled ? ""
                       : "<p class=\"lead\">Parts without a label are drawn as what they were "
                         "sorted into.</p>\n") +
         "<div class=\"side\">" + chart(DefectKind::kHole) + chart(DefectKind::kScratch) +
         "</div>\n";
}

std::string origin_section(const std::string& toml) {
  std::string text =
      "<h2>Settings and provenance</h2>\n<details><summary>Settings (TOML)"
      "</summary><pre>" +
      markup_text(toml) + "</pre></details>\n<table>\n";
  const Json origin = provenance();
  for (const auto& [name, value] : origin.items()) {
    text += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n",
                        markup_text(name),
                        markup_text(value.is_string() ? value.get<std::string>() : value.dump()));
  }
  return text + "</table>\n";
}

}  // namespace

PagePicture page_picture(const ImageF& shown) {
  return {.png = report_png(shown, kPictureWidthPx),
          .width_px = shown.width(),
          .height_px = shown.height()};
}

std::string inspect_page(const Json& result,
                         std::span<const InspectedPart> parts,
                         std::span<const PagePicture> pictures,
                         const InspectionSettings& settings,
                         const std::string& toml) {
  std::string text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
      "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta "
      "name=\"generator\" content=\"Glint\">\n<meta http-equiv=\"Content-Security-Policy\" "
      "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\">\n"
      "<title>Inspection - Glint</title>\n<style>{}</style>\n</head>\n<body>\n"
      "<p class=\"brand\">Glint</p>\n<h1>Inspection</h1>\n"
      "<p class=\"sentence\">{}</p>\n",
      kStyle,
      sentence(result, parts));
  for (const std::string& line : leads(result)) {
    text += fmt::format("<p class=\"lead\">{}</p>\n", line);
  }
  text += "<h2>Parts</h2>\n" + parts_table(parts, result.contains("truth"), pictures.size());
  const bool all_graded =
      std::ranges::all_of(parts, [](const InspectedPart& part) { return part.grade.has_value(); });
  if (parts.size() > 1 && all_graded) {
    text += sizes_section(parts, settings, result.contains("learned"));
  }
  text += "<h2>What was found</h2>\n";
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    text += part_section(parts[i], pictures[i], i + 1);
  }
  if (pictures.size() < parts.size()) {
    text +=
        fmt::format("<p class=\"lead\">The first {} parts; the folder has pictures of all.</p>\n",
                    pictures.size());
  }
  return text + origin_section(toml) + "</body>\n</html>\n";
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect_page.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "core/units.h"
#include "studies/chart.h"
#include "studies/population_drawing.h"
#include "studies/provenance.h"
#include "studies/report.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Json = nlohmann::ordered_json;

constexpr int kPictureWidthPx = 1300;
constexpr std::size_t kMostRows = 60;    ///< of a part's table; the CSV file has all
constexpr std::size_t kMostMarks = 600;  ///< in a part's picture

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

std::string html_text(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string plural(std::int64_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string badge(const std::optional<Grade>& grade) {
  return grade ? fmt::format("<span class=\"badge {0}\">{0}</span>", grade_name(*grade)) : "";
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

std::string cell(std::string_view text, bool is_number = true) {
  return fmt::format("<td{}>{}</td>", is_number ? " class=\"n\"" : "", text);
}

std::string heads(std::initializer_list<std::string_view> words) {
  std::string text = "<tr>";
  for (const std::string_view word : words) {
    const bool is_text = word.starts_with("!");
    text += fmt::format(
        "<th{}>{}</th>", is_text ? "" : " class=\"n\"", is_text ? word.substr(1) : word);
  }
  return text + "</tr>\n";
}

std::string number(double value) {
  return fmt::format("{:.4g}", value);
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
    const std::string name = html_text(part.source.name);
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

/// Numbers of defects, the biggest first.
std::vector<std::size_t> by_size(const std::vector<FoundDefect>& defects) {
  std::vector<std::size_t> order(defects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return defects[a].area_px > defects[b].area_px; });
  return order;
}

std::string known_as(const InspectedPart& part, std::size_t blob) {
  const int known = part.comparison->defect_of_blob[blob];
  return known < 0 ? "false alarm" : html_text(part.known[static_cast<std::size_t>(known)].label);
}

std::string defects_table(const InspectedPart& part) {
  const std::vector<FoundDefect>& defects = part.inspection.defects;
  if (defects.empty()) {
    return "<p class=\"lead\">No defect was found.</p>\n";
  }
  std::string text = "<div class=\"scroll\"><table>\n";
  text += heads({"number",
                 "!kind",
                 "x px",
                 "y px",
                 "area px",
                 "weight",
                 "peak",
                 "length px",
                 "width px",
                 "angle deg",
                 "elongation",
                 part.comparison ? "!is" : "!"});
  const std::vector<std::size_t> order = by_size(defects);
  for (std::size_t i = 0; i < std::min(order.size(), kMostRows); ++i) {
    const FoundDefect& defect = defects[order[i]];
    text += "<tr>" + cell(fmt::format("{}", order[i] + 1)) +
            cell(fmt::format("{} {}", defect.is_bright ? "bright" : "dark", kind_name(defect.kind)),
                 false) +
            cell(fmt::format("{:.1f}", defect.x_px)) + cell(fmt::format("{:.1f}", defect.y_px)) +
            cell(fmt::format("{}", defect.area_px)) + cell(number(defect.weight)) +
            cell(number(defect.peak)) + cell(fmt::format("{:.1f}", defect.length_px)) +
            cell(fmt::format("{:.1f}", defect.width_px)) +
            cell(fmt::format("{:.0f}", defect.angle_rad * kDegPerRad)) +
            cell(fmt::format("{:.2f}", defect.elongation)) +
            cell(part.comparison ? known_as(part, order[i]) : "", false) + "</tr>\n";
  }
  text += "</table></div>\n";
  if (order.size() > kMostRows) {
    text += fmt::format("<p class=\"lead\">The {} biggest of {}; defects.csv has all.</p>\n",
                        kMostRows,
                        order.size());
  }
  return text;
}

std::string mark_svg(const DefectMark& mark, double line_width, const std::string& title) {
  std::string points;
  Vector2d right = mark.outline.front();
  for (const Vector2d& point : mark.outline) {
    points += fmt::format("{:.1f},{:.1f} ", point.x(), point.y());
    right = point.x() > right.x() ? point : right;
  }
  const bool is_missed = mark.kind == DefectMark::Kind::kMissed;
  std::string text = fmt::format(
      "<g><title>{}</title><polygon points=\"{}\" fill=\"none\" stroke=\"{}\" "
      "stroke-width=\"{:.2f}\"{}/>",
      html_text(title),
      points,
      mark_colour(mark.kind),
      line_width,
      is_missed ? fmt::format(" stroke-dasharray=\"{0:.1f} {0:.1f}\"", 4.0 * line_width) : "");
  if (!is_missed) {
    text +=
        fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\" font-size=\"{:.1f}\">{}</text>",
                    right.x() + 2.0 * line_width,
                    right.y() + 4.0 * line_width,
                    mark_colour(mark.kind),
                    9.0 * line_width,
                    mark.number);
  }
  return text + "</g>\n";
}

std::string picture_svg(const InspectedPart& part, const PagePicture& picture) {
  const double line_width = std::max(0.6, picture.width_px / 950.0);
  std::string text = fmt::format(
      "<svg class=\"picture\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
      "font-family=\"Helvetica, Arial, sans-serif\">\n<image width=\"{0}\" height=\"{1}\" "
      "preserveAspectRatio=\"none\" href=\"data:image/png;base64,{2}\"/>\n",
      picture.width_px,
      picture.height_px,
      picture.png);
  const std::vector<DefectMark> marks = marks_of(part.inspection.defects);
  std::size_t drawn = 0;
  for (const std::size_t i : by_size(part.inspection.defects)) {
    const FoundDefect& defect = part.inspection.defects[i];
    if (drawn++ < kMostMarks) {
      text += mark_svg(marks[i],
                       line_width,
                       fmt::format("{} {}: {} px", kind_name(defect.kind), i + 1, defect.area_px));
    }
  }
  if (part.comparison) {
    for (const DefectMark& mark : missed_marks(part.known, *part.comparison)) {
      const KnownDefect& known = part.known[static_cast<std::size_t>(mark.number - 1)];
      text += mark_svg(mark, line_width, "missed: " + known.label);
    }
  }
  return text + "</svg>\n";
}

std::string legend(bool has_truth) {
  const auto key = [](std::string_view name, DefectMark::Kind kind, std::string_view words) {
    return fmt::format(
        "<span class=\"key {}\" style=\"color:{}\"></span>{}", name, mark_colour(kind), words);
  };
  return "<p class=\"lead\">Grey values stretched; what is darkened was not looked at." +
         key("hole", DefectMark::Kind::kHole, "hole or bump") +
         key("scratch", DefectMark::Kind::kScratch, "scratch") +
         (has_truth ? key("missed", DefectMark::Kind::kMissed, "missed") : "") + "</p>\n";
}

/// Pixels by their response, with the threshold.
std::string histogram_svg(const InspectedPart& part) {
  const ResponseHistogram& histogram = part.histogram;
  const double most = std::ranges::max(histogram.counts);
  const ChartAxis x = {.low = -histogram.reach, .high = histogram.reach, .from = 62.0, .to = 500.0};
  const ChartAxis y = {.scale = ChartAxis::Scale::kLog,
                       .low = 0.5,
                       .high = std::max(10.0, 2.0 * most),
                       .from = 200.0,
                       .to = 34.0};
  SvgPage page;
  page.text({62.0, 18.0}, "Pixels by response", "start", 0.0, R"(font-weight="bold")");
  draw_x_axis(page, x, y.to, y.from, "response (share of full scale)");
  draw_y_axis(page, y, x.from, x.to, "pixels");
  const double bin = 2.0 * histogram.reach / static_cast<double>(histogram.counts.size());
  const double threshold = part.inspection.threshold;
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    if (histogram.counts[i] > 0.0) {
      const double middle = -histogram.reach + (static_cast<double>(i) + 0.5) * bin;
      const double left = x.place(middle - 0.5 * bin);
      const double right = x.place(middle + 0.5 * bin);
      const double top = y.place(histogram.counts[i]);
      page.shape("polygon",
                 {{left, y.from}, {left, top}, {right, top}, {right, y.from}},
                 fmt::format("fill=\"{}\"", std::abs(middle) >= threshold ? "#d55e00" : "#7f9db5"));
    }
  }
  for (const double at : {-threshold, threshold}) {
    page.line({x.place(at), y.to}, {x.place(at), y.from}, R"(stroke="#b84a00" stroke-width="1.5")");
  }
  page.text(
      {x.place(threshold) + 4.0, y.to + 12.0}, "threshold", "start", 0.0, R"(fill="#b84a00")");
  return page.document(520.0, 246.0, "Pixels by response of " + part.source.name);
}

std::string part_section(const InspectedPart& part,
                         const PagePicture& picture,
                         std::size_t number) {
  std::string text = fmt::format(
      "<h3 id=\"part{}\">{} {}</h3>\n", number, html_text(part.source.name), badge(part.grade));
  text += fmt::format("<p class=\"lead\">{}, {} x {} px, {} bits; part from: {}.</p>\n",
                      plural(static_cast<std::int64_t>(part.source.pictures.size()), "picture"),
                      part.width_px,
                      part.height_px,
                      part.bits,
                      part.mask_from);
  if (!part.notes.empty()) {
    text += "<ul class=\"notes\">";
    for (const std::string& note : part.notes) {
      text += "<li>" + html_text(note) + "</li>";
    }
    text += "</ul>\n";
  }
  text += picture_svg(part, picture) + legend(part.comparison.has_value());
  return text + "<div class=\"side\"><div>" + defects_table(part) + "</div><div>" +
         histogram_svg(part) + "</div></div>\n";
}

std::string sizes_section(std::span<const InspectedPart> parts,
                          const InspectionSettings& settings) {
  const auto chart = [&](DefectKind kind) {
    const bool is_hole = kind == DefectKind::kHole;
    SizesChart sizes;
    sizes.title = is_hole ? "Holes and bumps" : "Scratches";
    sizes.unit = settings.measure == InspectionSettings::Measure::kArea ? "px" : "weight";
    sizes.limits = is_hole ? settings.holes : settings.scratches;
    for (const InspectedPart& part : parts) {
      sizes.points.push_back({.sizes = is_hole ? part.holes : part.scratches,
                              .expert = part.label ? *part.label : *part.grade,
                              .is_wrong = part.label && *part.label != *part.grade});
    }
    return sizes_svg(sizes);
  };
  return "<h2>Biggest defect and sum of all</h2>\n<div class=\"side\">" + chart(DefectKind::kHole) +
         chart(DefectKind::kScratch) + "</div>\n";
}

std::string origin_section(const std::string& toml) {
  std::string text =
      "<h2>Settings and provenance</h2>\n<details><summary>Settings (TOML)"
      "</summary><pre>" +
      html_text(toml) + "</pre></details>\n<table>\n";
  const Json origin = provenance();
  for (const auto& [name, value] : origin.items()) {
    text += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n",
                        html_text(name),
                        html_text(value.is_string() ? value.get<std::string>() : value.dump()));
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
    text += sizes_section(parts, settings);
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

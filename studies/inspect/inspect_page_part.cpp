// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_page_part.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/text.h"
#include "core/units.h"
#include "studies/drawing/chart.h"
#include "studies/inspect/inspect_html.h"

namespace glint::inspect_html {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kMostRows = 60;    ///< of a part's table; the CSV file has all
constexpr std::size_t kMostMarks = 600;  ///< in a part's picture

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
  if (known < 0) {
    return "false alarm";
  }
  const auto i = static_cast<std::size_t>(known);
  return markup_text(part.known[i].label) +
         (part.comparison->blob_of_defect[i] == static_cast<int>(blob) ? "" : " (beside it)");
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

std::string mark_svg(const DefectMark& mark,
                     double line_width,
                     const std::string& title,
                     bool has_number) {
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
      markup_text(title),
      points,
      mark_colour(mark.kind),
      line_width,
      is_missed ? fmt::format(" stroke-dasharray=\"{0:.1f} {0:.1f}\"", 4.0 * line_width) : "");
  if (has_number) {
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
  const std::vector<std::size_t> order = by_size(part.inspection.defects);
  for (std::size_t k = 0; k < std::min(order.size(), kMostMarks); ++k) {
    const FoundDefect& defect = part.inspection.defects[order[k]];
    const std::string title =
        fmt::format("{} {}: {} px", kind_name(defect.kind), order[k] + 1, defect.area_px);
    text += mark_svg(marks[order[k]], line_width, title, k < kMostRows);
  }
  if (part.comparison) {
    for (const DefectMark& mark : missed_marks(part.known, *part.comparison)) {
      const KnownDefect& known = part.known[static_cast<std::size_t>(mark.number - 1)];
      text += mark_svg(mark, line_width, "missed: " + known.label, false);
    }
  }
  return text + "</svg>\n";
}

std::string legend(bool has_truth) {
  const auto key = [](std::string_view name, DefectMark::Kind kind, std::string_view words) {
    return fmt::format(
        "<span class=\"key {}\" style=\"color:{}\"></span>{}", name, mark_colour(kind), words);
  };
  return "<p class=\"lead\">Grey values stretched; darkened areas were not inspected." +
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

}  // namespace

std::string part_section(const InspectedPart& part, const PagePicture& picture, std::size_t index) {
  std::string text = fmt::format(
      "<h3 id=\"part{}\">{} {}</h3>\n", index, markup_text(part.source.name), badge(part.grade));
  text += fmt::format("<p class=\"lead\">{}, {} x {} px, {} bits; part from: {}.</p>\n",
                      plural(static_cast<std::int64_t>(part.source.pictures.size()), "picture"),
                      part.width_px,
                      part.height_px,
                      part.bits,
                      part.mask_from);
  if (!part.notes.empty()) {
    text += "<ul class=\"notes\">";
    for (const std::string& note : part.notes) {
      text += "<li>" + markup_text(note) + "</li>";
    }
    text += "</ul>\n";
  }
  text += picture_svg(part, picture) + legend(part.comparison.has_value());
  return text + "<div class=\"side\"><div>" + defects_table(part) + "</div><div>" +
         histogram_svg(part) + "</div></div>\n";
}

}  // namespace glint::inspect_html

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/svg_page.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/text.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kWidthPerLetter = 6.7;  // of the drawing's 12.5 unit letters, on average
constexpr double kShortestSpan = 16.0;   // shorter dimensions get their arrows from outside
constexpr double kLongestBar = 90.0;
constexpr double kLineHeight = 16.0;
constexpr double kPaperWidth_mm = 190.0;   // of A4 between its margins
constexpr double kPaperHeight_mm = 277.0;  // likewise

/// Fixed to 2 decimals and never "-0", so that equal drawings have equal text.
std::string coordinate(double value) {
  const double rounded = std::round(value * 100.0) / 100.0;
  return shortest(rounded == 0.0 ? 0.0 : rounded);
}

std::string thin_line(double width) {
  return fmt::format(R"(fill="none" stroke="{}" stroke-width="{}")", kDrawingSoft, width);
}

/// Turns a direction into the angle in [-90, 90) at which words along it are upright or, on a
/// vertical line, are read from the right.
double reading_angle_deg(const Vector2d& along) {
  double angle_deg = std::atan2(along.y(), along.x()) * kDegPerRad;
  if (angle_deg >= 90.0 - 1e-9) {
    angle_deg -= 180.0;
  } else if (angle_deg < -90.0 - 1e-9) {
    angle_deg += 180.0;
  }
  return angle_deg;
}

}  // namespace

PaperScale paper_scale(double scale, double width, double height) {
  const double max_mm = std::min(kPaperWidth_mm / width, kPaperHeight_mm / height);
  const double least = 1.0 / (scale * max_mm);  // mm of the drawn thing for a mm of paper
  double ratio = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {2.0, 5.0, 10.0}) {
    if (ratio >= least * (1.0 - 1e-9)) {
      break;
    }
    ratio = factor * std::pow(10.0, std::floor(std::log10(least)));
  }
  return {.unit_mm = 1.0 / (scale * ratio), .words = scale_text(scale, 1.0 / (scale * ratio))};
}

std::string scale_text(double scale, double unit_mm) {
  const double ratio = 1.0 / (scale * unit_mm);
  return ratio >= 1.0 ? fmt::format("1 : {:.3g}", ratio) : fmt::format("{:.3g} : 1", 1.0 / ratio);
}

std::vector<std::string> wrapped(std::string_view text, std::size_t letters) {
  std::vector<std::string> lines(1);
  for (const std::string& word : split(text, ' ')) {
    std::string& last = lines.back();
    if (last.empty()) {
      last = word;
    } else if (last.size() + 1 + word.size() <= letters) {
      last += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

void SvgPage::line(const Vector2d& a, const Vector2d& b, std::string_view style) {
  body_ += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {}/>\n",
                       coordinate(a.x()),
                       coordinate(a.y()),
                       coordinate(b.x()),
                       coordinate(b.y()),
                       style);
}

void SvgPage::shape(std::string_view tag,
                    const std::vector<Vector2d>& points,
                    std::string_view style) {
  std::string list;
  for (const Vector2d& point : points) {
    list += list.empty() ? "" : " ";
    list += coordinate(point.x()) + "," + coordinate(point.y());
  }
  body_ += fmt::format("<{} points=\"{}\" {}/>\n", tag, list, style);
}

void SvgPage::text(const Vector2d& at,
                   std::string_view words,
                   std::string_view anchor,
                   double angle_deg,
                   std::string_view style) {
  std::string more;
  if (angle_deg != 0.0) {
    more += fmt::format(" transform=\"rotate({} {} {})\"",
                        coordinate(angle_deg),
                        coordinate(at.x()),
                        coordinate(at.y()));
  }
  if (!style.empty()) {
    more += fmt::format(" {}", style);
  }
  // The white rim keeps letters readable where a line runs behind them.
  body_ += fmt::format(
      "<text x=\"{}\" y=\"{}\" text-anchor=\"{}\" paint-order=\"stroke\" "
      "stroke=\"#ffffff\" stroke-width=\"3\"{}>{}</text>\n",
      coordinate(at.x()),
      coordinate(at.y()),
      anchor,
      more,
      markup_text(words));
}

void SvgPage::arrow(const Vector2d& tip, const Vector2d& direction) {
  const Vector2d back = tip - 7.0 * direction;
  const Vector2d side = 2.2 * Vector2d(-direction.y(), direction.x());
  shape("polygon", {tip, back + side, back - side}, fmt::format("fill=\"{}\"", kDrawingSoft));
}

void SvgPage::dimension(const Vector2d& a,
                        const Vector2d& b,
                        double offset,
                        std::string_view words) {
  const Vector2d along = (b - a).normalized();
  const Vector2d aside(along.y(), -along.x());
  const Vector2d p = a + offset * aside;
  const Vector2d q = b + offset * aside;
  const Vector2d over = (offset < 0.0 ? -4.0 : 4.0) * aside;
  const std::string thin = thin_line(0.7);
  const double length = (q - p).norm();
  const bool is_short = length < kShortestSpan;
  line(a, p + over, thin);
  line(b, q + over, thin);
  const Vector2d tail = (is_short ? 14.0 : 0.0) * along;
  line(p - tail, q + tail, thin);
  arrow(p, is_short ? along : Vector2d(-along));
  arrow(q, is_short ? Vector2d(-along) : along);
  const bool is_upright = std::abs(along.y()) > std::abs(along.x());
  const double room = kWidthPerLetter * static_cast<double>(words.size()) + 4.0;
  if (length < room && !is_upright) {
    const double gap = is_short ? 18.0 : 6.0;
    const auto [left, right] = p.x() > q.x() ? std::pair(q, p) : std::pair(p, q);
    const bool has_room = right.x() + gap + room <= kDrawingWidth;
    text(has_room ? Vector2d(right + Vector2d(gap, 4.0)) : Vector2d(left + Vector2d(-gap, 4.0)),
         words,
         has_room ? "start" : "end");
    return;
  }
  const double angle_deg = reading_angle_deg(along);
  const double angle_rad = angle_deg * kRadPerDeg;
  const Vector2d above(std::sin(angle_rad), -std::cos(angle_rad));
  text(0.5 * (p + q) + 4.0 * above, words, "middle", angle_deg);
}

void SvgPage::break_mark(const Vector2d& at, const Vector2d& direction, double half_width) {
  const Vector2d side = half_width * Vector2d(-direction.y(), direction.x());
  const auto zigzag = [&](double shift) {
    std::vector<Vector2d> points;
    for (const Vector2d& knee : {Vector2d(-1.0, 0.0),
                                 Vector2d(-0.25, 0.0),
                                 Vector2d(-0.1, 4.0),
                                 Vector2d(0.1, -4.0),
                                 Vector2d(0.25, 0.0),
                                 Vector2d(1.0, 0.0)}) {
      points.emplace_back(at + knee.x() * side + (shift + knee.y()) * direction);
    }
    return points;
  };
  const std::vector<Vector2d> lower = zigzag(-3.0);
  const std::vector<Vector2d> upper = zigzag(3.0);
  std::vector<Vector2d> gap = lower;
  gap.insert(gap.end(), upper.rbegin(), upper.rend());
  shape("polygon", gap, "fill=\"#ffffff\"");
  shape("polyline", lower, thin_line(0.8));
  shape("polyline", upper, thin_line(0.8));
}

void SvgPage::scale_bar(const Vector2d& left, double scale) {
  double length_mm = std::pow(10.0, std::floor(std::log10(kLongestBar / scale)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * length_mm * scale <= kLongestBar) {
      length_mm *= factor;
      break;
    }
  }
  const Vector2d right = left + Vector2d(length_mm * scale, 0.0);
  const Vector2d tick(0.0, 3.0);
  const std::string thick = fmt::format(R"(stroke="{}" stroke-width="2")", kDrawingInk);
  line(left, right, thick);
  line(left - tick, left + tick, thick);
  line(right - tick, right + tick, thick);
  text(right + Vector2d(6.0, 4.0), length_text(length_mm), "start");
}

void SvgPage::axes(const Vector2d& corner, std::string_view across, std::string_view up) {
  line(corner, corner + Vector2d(20.0, 0.0), thin_line(1.0));
  line(corner, corner - Vector2d(0.0, 20.0), thin_line(1.0));
  arrow(corner + Vector2d(24.0, 0.0), {1.0, 0.0});
  arrow(corner - Vector2d(0.0, 24.0), {0.0, -1.0});
  text(corner + Vector2d(28.0, 4.0), across, "start");
  text(corner - Vector2d(0.0, 28.0), up);
}

double SvgPage::lines(const Vector2d& at,
                      const std::vector<std::string>& words,
                      double width,
                      std::string_view style) {
  double y = at.y();
  for (const std::string& text_of_line : words) {
    for (const std::string& part :
         wrapped(text_of_line, static_cast<std::size_t>(width / kWidthPerLetter))) {
      text({at.x(), y}, part, "start", 0.0, style);
      y += kLineHeight;
    }
  }
  return y;
}

std::string SvgPage::document(double width,
                              double height,
                              std::string_view title,
                              double unit_mm) const {
  const std::string size =
      unit_mm > 0.0
          ? fmt::format(R"(width="{}mm" height="{}mm")",
                        coordinate(width * unit_mm),
                        coordinate(height * unit_mm))
          : fmt::format(R"(width="{}" height="{}")", coordinate(width), coordinate(height));
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" {5} "
      "font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12.5\" "
      "fill=\"{2}\" role=\"img\">\n<title>{3}</title>\n{4}</svg>\n",
      coordinate(width),
      coordinate(height),
      kDrawingInk,
      markup_text(title),
      body_,
      size);
}

}  // namespace glint

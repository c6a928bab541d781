// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/text.h"
#include "core/units.h"
#include "studies/drawing/svg_page.h"
#include "studies/drawing/wall_plan.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kTextWidth = kDrawingWidth - 2.0 * kDrawingMargin;
constexpr double kTitleWidth = 0.82 * kTextWidth;  // of larger, bold letters
constexpr double kFootHeight = 20.0;
constexpr double kViewLeft = 64.0;       // room for the dimensions on the left
constexpr double kViewWidth = 308.0;     // widest a view may be
constexpr double kViewHeight = 240.0;    // highest a view may be
constexpr double kCameraHeight = 118.0;  // room above the walls for slot, view and camera
constexpr double kDimensionGap = 24.0;   // from the drawing to a dimension
constexpr double kFinestStripe = 0.7;    // narrower stripes would only be a grey of unknown meaning

constexpr std::string_view kDark = "#4a545d";

struct Box {
  Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity());
  Vector2d high = Vector2d::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }

  bool is_empty() const { return !(high.x() >= low.x()); }

  Vector2d size() const { return high - low; }

  std::vector<Vector2d> corners() const {
    return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  }
};

Box box_of(const std::vector<Vector2d>& points, Box box = {}) {
  for (const Vector2d& point : points) {
    box.add(point);
  }
  return box;
}

Box panel_box(const CrossSection& section) {
  Box box;
  for (const auto& panel : section.panels_yz_mm) {
    box = box_of(panel, box);
  }
  return box;
}

Box section_box(const CrossSection& section) {
  return box_of(section.part_yz_mm, panel_box(section));
}

/// A view: one scale for both axes, page position of a point in mm.
struct View {
  double scale = 0.0;
  Vector2d origin = {0.0, 0.0};  ///< page position of (0, 0) mm

  Vector2d operator()(const Vector2d& point_mm) const {
    return origin + scale * Vector2d(point_mm.x(), -point_mm.y());
  }

  std::vector<Vector2d> operator()(const std::vector<Vector2d>& points_mm) const {
    std::vector<Vector2d> points;
    points.reserve(points_mm.size());
    for (const Vector2d& point : points_mm) {
      points.push_back((*this)(point));
    }
    return points;
  }
};

double fitting_scale(const Vector2d& size_mm) {
  const double infinite = std::numeric_limits<double>::infinity();
  const double across = size_mm.x() > 0.0 ? kViewWidth / size_mm.x() : infinite;
  const double up = size_mm.y() > 0.0 ? kViewHeight / size_mm.y() : infinite;
  const double scale = std::min(across, up);
  return std::isfinite(scale) ? scale : 0.0;
}

/// Puts a box into the middle of the view's place, its top at the given height of the page.
View view_of(const Box& box, double scale, double top) {
  const double left = kViewLeft + 0.5 * (kViewWidth - scale * box.size().x());
  return {.scale = scale, .origin = {left - scale * box.low.x(), top + scale * box.high.y()}};
}

std::string stroke(std::string_view colour, double width, std::string_view more = "") {
  return fmt::format(R"(fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round"{}{})",
                     colour,
                     width,
                     more.empty() ? "" : " ",
                     more);
}

std::string filled(std::string_view colour) {
  return fmt::format(
      R"(fill="{}" stroke="{}" stroke-width="1" stroke-linejoin="round")", colour, kDrawingInk);
}

void draw_camera(SvgPage& page, const Vector2d& at, const Vector2d& view) {
  const Vector2d side(-view.y(), view.x());
  const auto block = [&](double near, double far, double half) {
    page.shape("polygon",
               {at + near * view + half * side,
                at + near * view - half * side,
                at + far * view - half * side,
                at + far * view + half * side},
               fmt::format(R"(fill="#ffffff" stroke="{}" stroke-width="1.3")", kDrawingInk));
  };
  block(0.0, -6.0, 6.0);
  block(-6.0, -20.0, 9.0);
}

/// Camera, axis and field of view over the cross-section. A camera beyond `ceiling` (a height of
/// the page) is drawn there, behind a break; directions are true all the same.
void draw_camera_view(SvgPage& page,
                      const CrossSection& section,
                      const View& view,
                      double ceiling) {
  const Vector2d camera_mm = section.camera_mm.tail<2>();
  if (camera_mm.norm() == 0.0) {
    return;
  }
  const Vector2d start = view(Vector2d(0.0, 0.0));
  const double full = view.scale * camera_mm.norm();
  const Vector2d away = (view(camera_mm) - start) / full;
  const Vector2d side(-away.y(), away.x());
  const bool is_above = away.y() < -0.5;
  const double reach = is_above ? (ceiling - start.y()) / away.y() : 0.5 * kViewWidth;
  const bool is_cut = full > reach;
  const double shown = is_cut ? (reach - 30.0) / full : 1.0;
  const double spread = full * std::tan(std::clamp(section.view_half_angle_rad, 0.0, 1.4));
  if (spread > 0.0) {
    for (const double sign : {-1.0, 1.0}) {
      const Vector2d foot = start + sign * spread * side;
      page.line(foot,
                foot + shown * (start + full * away - foot),
                stroke(kDrawingRay, 0.8, "stroke-dasharray=\"5 3\""));
    }
  }
  const Vector2d place = start + std::min(full, reach) * away;
  page.line(start, place, stroke(kDrawingSoft, 0.7, "stroke-dasharray=\"9 3 2 3\""));
  if (is_cut) {
    const double half_width = std::clamp(spread * (1.0 - shown) + 8.0, 12.0, 60.0);
    page.break_mark(start + (reach - 27.0) * away, away, half_width);
  }
  draw_camera(page, place, -away);
  page.text(place + Vector2d(17.0, -4.0),
            fmt::format("camera {} away", length_text(section.camera_mm.norm())),
            "start");
}

void draw_walls_and_part(SvgPage& page, const CrossSection& section, const View& view) {
  for (const auto& panel : section.panels_yz_mm) {
    page.shape("polyline", view(panel), stroke(kDrawingLight, 5.0));
    page.shape("polyline", view(panel), stroke(kDrawingInk, 0.8));
  }
  if (!section.part_yz_mm.empty()) {
    const char* tag = section.part_yz_mm.size() < 3 ? "polyline" : "polygon";
    page.shape(tag, view(section.part_yz_mm), filled(kDrawingPart));
  }
}

void draw_section_dimensions(SvgPage& page, const CrossSection& section, const View& view) {
  const Box panels = panel_box(section);
  const Box part = box_of(section.part_yz_mm);
  if (panels.is_empty()) {
    return;
  }
  const Vector2d low = view(section_box(section).low);
  const Vector2d high = view(section_box(section).high);
  const Vector2d wall_low = view(panels.low);
  const Vector2d wall_high = view(panels.high);
  if (panels.size().x() > 0.0) {
    page.dimension({wall_high.x(), low.y()},
                   {wall_low.x(), low.y()},
                   kDimensionGap,
                   length_text(panels.size().x()));
  }
  if (panels.size().y() > 0.0) {
    page.dimension({high.x(), wall_low.y()},
                   {high.x(), wall_high.y()},
                   -kDimensionGap,
                   length_text(panels.size().y()));
  }
  if (!part.is_empty() && panels.high.y() > part.high.y()) {
    const Vector2d top = view(Vector2d(part.low.x(), part.high.y()));
    page.line({low.x(), top.y()}, top, stroke(kDrawingSoft, 0.7));
    page.dimension({low.x(), top.y()},
                   {low.x(), wall_high.y()},
                   kDimensionGap,
                   length_text(panels.high.y() - part.high.y()));
  }
  if (section.slot_mm > 0.0) {
    page.dimension(view(Vector2d(-0.5 * section.slot_mm, panels.high.y())),
                   view(Vector2d(0.5 * section.slot_mm, panels.high.y())),
                   16.0,
                   "slot " + length_text(section.slot_mm));
  }
}

/// The polygon's part where sign * (component - limit) >= 0.
std::vector<Vector2d> clipped(const std::vector<Vector2d>& polygon,
                              int component,
                              double limit,
                              double sign) {
  std::vector<Vector2d> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    const double inside_a = sign * (a[component] - limit);
    const double inside_b = sign * (b[component] - limit);
    if (inside_a >= 0.0) {
      kept.push_back(a);
    }
    if ((inside_a < 0.0) != (inside_b < 0.0)) {
      kept.emplace_back(a + inside_a / (inside_a - inside_b) * (b - a));
    }
  }
  return kept;
}

/// Bright stripes on a wall seen from the side; one begins at its middle.
void draw_stripes(SvgPage& page, const CrossSection& section, const View& view, const Box& wall) {
  const Vector2d across(std::cos(section.orientation_rad), std::sin(section.orientation_rad));
  const Vector2d middle = 0.5 * (wall.low + wall.high);
  const double reach = 0.5 * wall.size().norm();
  const Vector2d half = reach * Vector2d(-across.y(), across.x());
  const int count = static_cast<int>(std::ceil(reach / section.period_mm));
  for (int k = -count; k <= count; ++k) {
    const Vector2d a = middle + k * section.period_mm * across;
    const Vector2d b = a + section.duty * section.period_mm * across;
    std::vector<Vector2d> stripe = {a - half, b - half, b + half, a + half};
    for (const int component : {0, 1}) {
      stripe = clipped(stripe, component, wall.low[component], 1.0);
      stripe = clipped(stripe, component, wall.high[component], -1.0);
    }
    if (box_of(stripe).size().minCoeff() > 1e-9) {  // not cut away, nor down to a line
      page.shape(
          "polygon", view(stripe), fmt::format(R"(class="stripe" fill="{}")", kDrawingLight));
    }
  }
}

std::string rounded(double value, double factor) {
  return shortest(std::round(value * factor) / factor);
}

/// What is said about the fringes under the side elevation, line by line.
std::vector<std::string> fringe_lines(const CrossSection& section, bool is_drawn) {
  if (section.period_mm <= 0.0) {
    return {"plain walls, no fringes"};
  }
  std::vector<std::string> lines = {fmt::format(
      "period {}, bright share {}", length_text(section.period_mm), rounded(section.duty, 1000.0))};
  if (section.orientation_rad != 0.0) {
    lines[0] +=
        fmt::format(", turned by {}\u00b0", rounded(section.orientation_rad * kDegPerRad, 10.0));
  }
  if (!is_drawn) {
    lines[0] += " (too fine to draw)";
  }
  if (section.positions > 1) {
    lines.push_back(
        fmt::format("{} images, step {}", section.positions, length_text(section.step_mm)));
  } else if (section.positions == 1) {
    lines.emplace_back("one image");
  }
  return lines;
}

/// Draws the view across the axis from `top` downwards; returns the page height it ends at.
double draw_cross_section(SvgPage& page, const CrossSection& section, double top) {
  const Box all = section_box(section);
  const View view = view_of(all, cross_section_scale(section), top + kCameraHeight);
  const double bottom = view(all.low).y();
  page.text({kDrawingMargin, top + 12.0}, "Cross-section", "start", 0.0, "font-weight=\"bold\"");
  draw_camera_view(page, section, view, top + 44.0);
  draw_walls_and_part(page, section, view);
  draw_section_dimensions(page, section, view);
  page.axes({kDrawingMargin + 2.0, bottom + 54.0}, "y", "z");
  page.scale_bar({kViewLeft, bottom + 50.0}, view.scale);
  return bottom + 66.0;
}

/// Draws the view from the side from `top` downwards; returns the page height it ends at.
double draw_elevation(SvgPage& page, const CrossSection& section, double top) {
  const Box panels = panel_box(section);
  const Box part = box_of(section.part_yz_mm);
  const auto beside = [](double length_mm, const Box& across) {
    return Box{.low = {-0.5 * length_mm, across.low.y()},
               .high = {0.5 * length_mm, across.high.y()}};
  };
  const Box wall = beside(section.length_mm, panels);
  const bool has_part = section.part_length_mm > 0.0 && !part.is_empty();
  const Box side = beside(section.part_length_mm, part);
  const Box all = has_part ? box_of(side.corners(), wall) : wall;
  const View view = view_of(all, fitting_scale(all.size()), top + 52.0);
  const double bottom = view(all.low).y();
  const double narrowest = section.period_mm * std::min(section.duty, 1.0 - section.duty);
  const bool has_stripes = section.period_mm > 0.0 && narrowest * view.scale >= kFinestStripe;

  page.text({kDrawingMargin, top + 12.0}, "Side elevation", "start", 0.0, "font-weight=\"bold\"");
  page.shape(
      "polygon", view(wall.corners()), filled(section.period_mm > 0.0 ? kDark : kDrawingLight));
  if (has_stripes) {
    draw_stripes(page, section, view, wall);
  }
  if (has_stripes && section.orientation_rad == 0.0) {  // along x a turned period looks longer
    page.dimension(view(Vector2d(0.0, wall.high.y())),
                   view(Vector2d(section.period_mm, wall.high.y())),
                   14.0,
                   "period " + length_text(section.period_mm));
  }
  page.shape("polygon", view(wall.corners()), stroke(kDrawingInk, 1.0));
  if (has_part) {
    page.shape("polygon", view(side.corners()), filled(kDrawingPart));
  }
  page.dimension({view(wall.high).x(), bottom},
                 {view(wall.low).x(), bottom},
                 kDimensionGap,
                 length_text(section.length_mm));
  page.axes({kDrawingMargin + 2.0, bottom + 54.0}, "x", "z");
  page.scale_bar({kViewLeft, bottom + 50.0}, view.scale);
  double height = bottom + 66.0;
  for (const std::string& line : fringe_lines(section, has_stripes)) {
    height += 16.0;
    page.text({kDrawingMargin, height - 4.0}, line, "start");
  }
  return height + 4.0;
}

}  // namespace

double cross_section_scale(const CrossSection& section) {
  const Box all = section_box(section);
  return all.is_empty() ? 0.0 : fitting_scale(all.size());
}

std::string cross_section_svg(const CrossSection& section) {
  SvgPage page;
  double height = 8.0;
  if (!section.title.empty()) {
    height = page.lines({kDrawingMargin, 20.0},
                        {section.title},
                        kTitleWidth,
                        R"(font-size="14" font-weight="bold")") -
             4.0;
  }
  const double scale = cross_section_scale(section);
  if (scale > 0.0) {
    height = draw_cross_section(page, section, height);
    if (section.length_mm > 0.0 && !panel_box(section).is_empty()) {
      height = draw_elevation(page, section, height + 10.0);
    }
    height = page.lines({kDrawingMargin, height + 12.0}, wall_lines(section), kTextWidth) - 4.0;
  }
  const std::string title = section.title.empty() ? "Lighting, to scale" : section.title;
  if (scale <= 0.0) {
    return page.document(kDrawingWidth, height, title);
  }
  const PaperScale paper = paper_scale(scale, kDrawingWidth, height + kFootHeight);
  page.text({kDrawingMargin, height + 12.0},
            fmt::format("cross-section {} printed at 100 %, lengths in mm", paper.words),
            "start");
  return page.document(kDrawingWidth, height + kFootHeight, title, paper.unit_mm);
}

}  // namespace glint

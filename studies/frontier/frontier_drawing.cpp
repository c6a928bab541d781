// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "core/units.h"
#include "studies/drawing/svg_page.h"
#include "studies/frontier/frontier_errors.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kWidth = 760.0;
constexpr double kHeight = 492.0;
constexpr double kLeft = 74.0;
constexpr double kRight = 736.0;
constexpr double kTop = 96.0;
constexpr double kBottom = 434.0;
constexpr double kMarker = 5.5;

/// How points of one kind of method are drawn.
struct Look {
  std::string_view colour;
  std::string_view colour_with_facets;
  bool is_hollow = false;
  int corners = 24;  ///< of its marker
  double turn_rad = 0.0;
};

/// By ComparedMethod::kind.
constexpr std::array kLooks = {
    Look{.colour = "#0072b2", .colour_with_facets = "#56b4e9"},
    Look{.colour = "#d55e00", .colour_with_facets = "#cc79a7", .corners = 4},
    Look{
        .colour = "#009e73", .colour_with_facets = "#cc79a7", .corners = 4, .turn_rad = 0.25 * kPi},
    Look{.colour = kDrawingInk, .colour_with_facets = kDrawingInk, .is_hollow = true},
    Look{.colour = "#0072b2", .colour_with_facets = "#56b4e9"},
    Look{.colour = "#d55e00", .colour_with_facets = "#cc79a7", .corners = 4},
    Look{.colour = "#009e73",
         .colour_with_facets = "#cc79a7",
         .corners = 4,
         .turn_rad = 0.25 * kPi}};

/// The ring around the setting that the scene has now.
constexpr Look kCurrentLook = {.colour = "#c23b22"};

/// The ring around what the program would take by itself of path-traced rungs.
constexpr Look kChosenLook = {.colour = "#1b7f3b"};

/// Points that stand together in the legend.
struct Family {
  std::string name;
  Look look;
};

bool is_faceted(const FrontierPoint& point, const Frontier& frontier) {
  return point.tessellation != frontier.points.front().tessellation;
}

bool has_other_reflections(const FrontierPoint& point, const Frontier& frontier) {
  return point.method.is_noisy &&
         point.method.paths.max_reflections != frontier.points.front().method.paths.max_reflections;
}

Family family_of(const FrontierPoint& point, const Frontier& frontier) {
  Family family = {.name = point.method.kind_name, .look = kLooks.at(point.method.kind)};
  Look& look = family.look;
  if (point.reduction > 1) {
    family.name += ", half resolution";
    look.is_hollow = true;
  }
  if (is_faceted(point, frontier)) {
    family.name += ", facets";
    look.colour = look.colour_with_facets;
    look.corners = 3;
    look.turn_rad = -0.5 * kPi;
  }
  if (!point.realisation.empty()) {
    family.name += ", defects realised otherwise";
    look.colour = "#009e73";
    look.corners = 4;
  }
  if (has_other_reflections(point, frontier)) {
    family.name += ", other reflections";
    look.colour = "#d55e00";
    look.corners = 4;
    look.turn_rad = 0.25 * kPi;
  }
  return family;
}

/// Powers of ten along both axes.
struct Scale {
  Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity());  ///< log10
  Vector2d high = Vector2d::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vector2d& value) {
    const Vector2d power(std::log10(value.x()), std::log10(value.y()));
    low = low.cwiseMin(power);
    high = high.cwiseMax(power);
  }

  void round() {
    low = (low.array() - 0.08).floor();
    high = (high.array() + 0.08).ceil();
  }

  Vector2d place(const Vector2d& value) const {
    const Vector2d share =
        (Vector2d(std::log10(value.x()), std::log10(value.y())) - low).cwiseQuotient(high - low);
    return {kLeft + share.x() * (kRight - kLeft), kBottom - share.y() * (kBottom - kTop)};
  }
};

/// CPU milliseconds and frame error, where both can stand on axes of powers of ten. What the
/// reference's noise hides stands a little below that noise.
std::optional<Vector2d> value_of(const FrontierPoint& point, const Frontier& frontier) {
  constexpr double kBelow = 0.5;
  const double least = frontier.reference.method.is_noisy
                           ? kBelow * frontier.reference.own_frame_rmse.value_or(0.0)
                           : 0.0;
  const auto error = error_of(point, kFrameRmse);
  if (!error || !(std::max(*error, least) > 0.0) || !(point.cpu_s > 0.0)) {
    return std::nullopt;
  }
  return Vector2d(point.cpu_s * 1e3, std::max(*error, least));
}

std::string power_text(double power) {
  return fmt::format("{:g}", std::pow(10.0, power));
}

class Chart {
 public:
  explicit Chart(const Frontier& frontier) : frontier_(frontier) {
    for (const FrontierPoint& point : frontier.points) {
      if (const auto value = value_of(point, frontier)) {
        scale_.add(*value);
        has_points_ = true;
      }
    }
    if (!has_points_) {
      scale_ = {.low = Vector2d(0.0, -3.0), .high = Vector2d(3.0, 0.0)};
    }
    scale_.round();
  }

  std::string draw(const std::string& title) {
    page_.text({kLeft, 22.0}, title, "start", 0.0, R"(font-weight="bold")");
    axes();
    reference();
    front();
    for (const FrontierPoint& point : frontier_.points) {
      if (const auto value = value_of(point, frontier_)) {
        label(point, scale_.place(*value));
      }
    }
    for (const FrontierPoint& point : frontier_.points) {  // over the white rims of the letters
      if (const auto value = value_of(point, frontier_)) {
        marker(scale_.place(*value), family_of(point, frontier_).look, point.method.is_choice);
        if (point.is_chosen) {
          marker(scale_.place(*value), kChosenLook, true);
        }
        if (point.method.is_current) {
          marker(scale_.place(*value), kCurrentLook, true);
        }
      }
    }
    legend();
    return page_.document(kWidth, kHeight, title);
  }

 private:
  void axes() {
    const std::string_view grid = R"(stroke="#dde2e6" stroke-width="1")";
    double power = scale_.low.x();
    while (power <= scale_.high.x() + 0.5) {
      const double x = scale_.place({std::pow(10.0, power), 1.0}).x();
      page_.line({x, kTop}, {x, kBottom}, grid);
      page_.text({x, kBottom + 18.0}, power_text(power));
      power += 1.0;
    }
    power = scale_.low.y();
    while (power <= scale_.high.y() + 0.5) {
      const double y = scale_.place({1.0, std::pow(10.0, power)}).y();
      page_.line({kLeft, y}, {kRight, y}, grid);
      page_.text({kLeft - 8.0, y + 4.0}, power_text(power), "end");
      power += 1.0;
    }
    page_.text({0.5 * (kLeft + kRight), kBottom + 42.0},
               frontier_.reference.method.is_noisy
                   ? "CPU time of one more picture and its scores, all threads (ms)"
                   : "CPU time of one more candidate, one thread (ms)");
    if (frontier_.pixel_factor > 1) {
      page_.text({kRight, kTop - 5.0},
                 fmt::format("pictures reduced to {} x {} px, 1/{} along both sides",
                             frontier_.width_px,
                             frontier_.height_px,
                             frontier_.pixel_factor),
                 "end",
                 0.0,
                 R"(font-size="11")");
    }
    page_.text({20.0, 0.5 * (kTop + kBottom)}, "frame error (RMSE, full scale 1)", "middle", -90.0);
  }

  /// Below the reference's own error nothing can be told apart.
  void reference() {
    const auto own = frontier_.reference.own_frame_rmse;
    if (!own || !(*own > 0.0)) {
      return;
    }
    const double y = scale_.place({1.0, *own}).y();
    if (y < kBottom && y > kTop) {
      page_.line({kLeft, y}, {kRight, y}, R"(stroke="#8a949e" stroke-dasharray="2 3")");
      page_.text({kRight, y - 4.0}, "error of the reference itself, about", "end");
    }
  }

  void front() {
    std::vector<Vector2d> values;
    for (const FrontierPoint& point : frontier_.points) {
      const auto value = value_of(point, frontier_);
      if (value && std::ranges::count(point.on_front, kFrameRmse) > 0) {
        values.push_back(*value);
      }
    }
    std::ranges::sort(values, {}, [](const Vector2d& value) { return value.x(); });
    std::vector<Vector2d> steps;
    for (const Vector2d& value : values) {
      const Vector2d at = scale_.place(value);
      if (!steps.empty()) {
        steps.emplace_back(at.x(), steps.back().y());
      }
      steps.push_back(at);
    }
    if (steps.size() > 1) {
      page_.shape("polyline",
                  steps,
                  R"(fill="none" stroke="#6b7680" stroke-width="1.2" stroke-dasharray="5 4")");
    }
  }

  void marker(const Vector2d& at, const Look& look, bool is_choice) {
    const double radius = is_choice ? 1.9 * kMarker : kMarker;
    std::vector<Vector2d> corners;
    for (int i = 0; i < look.corners; ++i) {
      const double angle_rad = look.turn_rad + 2.0 * kPi * i / look.corners;
      corners.emplace_back(at + radius * Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    }
    const std::string_view fill = is_choice ? "none" : look.is_hollow ? "#ffffff" : look.colour;
    page_.shape("polygon",
                corners,
                fmt::format(R"(fill="{}" stroke="{}" stroke-width="{}")",
                            fill,
                            look.colour,
                            is_choice ? 2.0 : 1.4));
  }

  /// What a point is: rays a pixel, or the allowed error of directions; where there is room.
  void label(const FrontierPoint& point, const Vector2d& at) {
    const ComparedMethod& method = point.method;
    if (is_faceted(point, frontier_) || method.is_choice) {
      return;
    }
    const bool has_rays = method.rays_per_px > 0 || method.is_noisy;
    const Vector2d corner = at + (has_rays ? Vector2d(8.0, -6.0) : Vector2d(9.0, 15.0));
    const bool is_crowded = std::ranges::any_of(labels_, [&](const Vector2d& other) {
      return std::abs(other.x() - corner.x()) < 32.0 && std::abs(other.y() - corner.y()) < 11.0;
    });
    if (!is_crowded) {
      page_.text(corner, label_of(point), "start", 0.0, R"(font-size="10.5")");
      labels_.push_back(corner);
    }
  }

  std::string label_of(const FrontierPoint& point) const {
    const ComparedMethod& method = point.method;
    if (!point.realisation.empty()) {
      return point.realisation;
    }
    if (method.is_noisy) {
      return has_other_reflections(point, frontier_)
                 ? fmt::format("{} refl.", method.paths.max_reflections)
                 : fmt::format("{}", method.paths.samples);
    }
    return method.rays_per_px > 0 ? fmt::format("{}", method.rays_per_px)
                                  : fmt::format("{:g} mrad", method.direction_mrad);
  }

  void legend() {
    std::vector<std::string> known;
    for (const FrontierPoint& point : frontier_.points) {
      const Family family = family_of(point, frontier_);
      if (!value_of(point, frontier_) || std::ranges::count(known, family.name) > 0) {
        continue;
      }
      legend_entry(known.size(), family, false);
      known.push_back(family.name);
    }
    const bool has_current = std::ranges::any_of(frontier_.points, [&](const FrontierPoint& point) {
      return point.method.is_current && value_of(point, frontier_);
    });
    if (has_current) {
      legend_entry(known.size(), {"the scene's own setting", kCurrentLook}, true);
    }
    if (std::ranges::any_of(frontier_.points, &FrontierPoint::is_chosen)) {
      legend_entry(known.size() + 1, {"the automatic choice", kChosenLook}, true);
    }
  }

  void legend_entry(std::size_t place, const Family& family, bool is_ring) {
    const auto index = static_cast<double>(place);
    const double column = std::fmod(index, 3.0);
    const Vector2d at(kLeft + 6.0 + 225.0 * column, 40.0 + 18.0 * std::floor(index / 3.0));
    marker(at, family.look, is_ring);
    page_.text(at + Vector2d(12.0, 4.0), family.name, "start");
  }

  const Frontier& frontier_;
  SvgPage page_;
  std::vector<Vector2d> labels_;
  Scale scale_;
  bool has_points_ = false;
};

}  // namespace

std::string frontier_svg(const Frontier& frontier, const std::string& title) {
  return Chart(frontier).draw(title);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/sizes_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/units.h"
#include "studies/drawing/chart.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kWidth = 560.0;
constexpr double kHeight = 470.0;
constexpr double kLeft = 68.0;
constexpr double kRight = 540.0;
constexpr double kTop = 84.0;
constexpr double kBottom = 420.0;

struct GradeLook {
  Mark form;
  std::string_view colour;
};

constexpr std::array<GradeLook, 3> kLooks = {
    {{Mark::kCircle, "#009e73"}, {Mark::kSquare, "#e69f00"}, {Mark::kTriangle, "#c0392b"}}};

const GradeLook& look_of(Grade grade) {
  return kLooks[static_cast<std::size_t>(grade)];
}

class SizesDrawing {
 public:
  explicit SizesDrawing(const SizesChart& chart) : chart_(chart) {
    double biggest = 1.0;
    double sum = 1.0;
    for (const SizesPoint& point : chart.points) {
      biggest = std::max(biggest, point.sizes.biggest);
      sum = std::max(sum, point.sizes.sum);
    }
    const ChartAxis::Scale root = ChartAxis::Scale::kRoot;
    x_ = {.scale = root, .high = 1.08 * biggest, .from = kLeft, .to = kRight};
    y_ = {.scale = root, .high = 1.08 * sum, .from = kBottom, .to = kTop};
  }

  std::string draw() {
    page_.text({kLeft, 22.0}, chart_.title, "start", 0.0, R"(font-weight="bold")");
    draw_x_axis(
        page_, x_, kTop, kBottom, fmt::format("biggest defect of the part ({})", chart_.unit));
    draw_y_axis(page_, y_, kLeft, kRight, fmt::format("sum of all its defects ({})", chart_.unit));
    limit(chart_.limits.perfect_biggest, chart_.limits.perfect_sum, Grade::kPerfect);
    if (chart_.limits.acceptable_biggest > chart_.limits.perfect_biggest ||
        chart_.limits.acceptable_sum > chart_.limits.perfect_sum) {
      limit(chart_.limits.acceptable_biggest, chart_.limits.acceptable_sum, Grade::kAcceptable);
    }
    points();
    legend();
    return page_.document(kWidth, kHeight, chart_.title);
  }

 private:
  Vector2d place(const DefectSizes& sizes) const {
    return {x_.place(sizes.biggest), y_.place(sizes.sum)};
  }

  /// The box within which parts get a grade; a side beyond the chart is left out.
  void limit(double biggest, double sum, Grade grade) {
    const std::string style = fmt::format(
        R"(stroke="{}" stroke-width="1.6" stroke-dasharray="6 4")", look_of(grade).colour);
    const double x = x_.place(biggest);
    const double y = y_.place(sum);
    if (biggest < x_.high) {
      page_.line({x, kBottom}, {x, y}, style);
    }
    if (sum < y_.high) {
      page_.line({kLeft, y}, {x, y}, style);
    }
    page_.text({kLeft + 6.0, y - 5.0},
               std::string(grade_name(grade)) + " below",
               "start",
               0.0,
               fmt::format(R"(font-size="11" fill="{}")", look_of(grade).colour));
  }

  /// Rejected parts first, so that the few among the good ones are seen.
  void points() {
    int at_origin = 0;
    for (const Grade grade : {Grade::kRejected, Grade::kAcceptable, Grade::kPerfect}) {
      for (const SizesPoint& point : chart_.points) {
        if (point.expert == grade) {
          draw_mark(page_,
                    place(point.sizes),
                    look_of(grade).form,
                    look_of(grade).colour,
                    !point.is_test,
                    3.6);
          at_origin += point.sizes.sum <= 0.0 ? 1 : 0;
        }
      }
    }
    for (const SizesPoint& point : chart_.points) {
      if (point.is_wrong && point.is_test) {
        ring(place(point.sizes));
      }
    }
    if (at_origin > 0) {
      page_.text({kLeft + 9.0, kBottom - 7.0},
                 fmt::format("{} parts with none", at_origin),
                 "start",
                 0.0,
                 R"(font-size="11")");
    }
  }

  void ring(const Vector2d& at) {
    std::vector<Vector2d> corners;
    for (int i = 0; i < 24; ++i) {
      const double angle_rad = 2.0 * kPi * i / 24;
      corners.emplace_back(at + 8.5 * Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    }
    page_.shape("polygon",
                corners,
                fmt::format(R"(fill="none" stroke="{}" stroke-width="1.6")", kDrawingInk));
  }

  void legend() {
    page_.text({kLeft, 46.0}, "The expert says", "start");
    double x = kLeft + 118.0;
    for (const Grade grade : {Grade::kPerfect, Grade::kAcceptable, Grade::kRejected}) {
      if (grade == Grade::kAcceptable && !has(grade)) {
        continue;
      }
      draw_mark(page_, {x, 42.0}, look_of(grade).form, look_of(grade).colour);
      page_.text({x + 10.0, 46.0}, std::string(grade_name(grade)), "start");
      x += grade == Grade::kAcceptable ? 104.0 : 84.0;
    }
    draw_mark(page_, {kLeft + 6.0, 62.0}, Mark::kCircle, kDrawingSoft, true);
    page_.text({kLeft + 16.0, 66.0}, "limits learned from it", "start");
    draw_mark(page_, {kLeft + 172.0, 62.0}, Mark::kCircle, kDrawingSoft);
    page_.text({kLeft + 182.0, 66.0}, "limits tested on it", "start");
    ring({kLeft + 316.0, 62.0});
    page_.text({kLeft + 330.0, 66.0}, "sorted otherwise", "start");
  }

  bool has(Grade grade) const {
    return std::ranges::any_of(chart_.points,
                               [&](const SizesPoint& point) { return point.expert == grade; });
  }

  const SizesChart& chart_;
  SvgPage page_;
  ChartAxis x_;
  ChartAxis y_;
};

}  // namespace

std::string sizes_svg(const SizesChart& chart) {
  return SizesDrawing(chart).draw();
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/pod_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "studies/drawing/chart.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kWidth = 760.0;
constexpr double kLeft = 68.0;
constexpr double kRight = 736.0;
constexpr double kTop = 44.0;
constexpr double kBottom = 384.0;
constexpr int kCurvePoints = 160;

constexpr std::array<std::string_view, 6> kColours = {
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};
constexpr std::array<Mark, 4> kMarks = {
    Mark::kCircle, Mark::kSquare, Mark::kTriangle, Mark::kDiamond};

class PodDrawing {
 public:
  explicit PodDrawing(const PodChart& chart) : chart_(chart) {
    double low = std::numeric_limits<double>::infinity();
    double high = 0.0;
    for (const PodCurve& curve : chart.curves) {
      for (const PodLevel& level : curve.levels) {
        low = std::min(low, level.size);
        high = std::max(high, level.size);
      }
    }
    if (!(low < high)) {
      low = high > 0.0 ? 0.5 * high : 0.5;
      high = 4.0 * low;
    }
    x_ = {.scale = ChartAxis::Scale::kLog,
          .low = 0.9 * low,
          .high = 1.1 * high,
          .from = kLeft,
          .to = kRight};
    y_ = {.low = 0.0, .high = 100.0, .from = kBottom, .to = kTop};
  }

  std::string draw() {
    page_.text({kLeft, 22.0}, chart_.title, "start", 0.0, R"(font-weight="bold")");
    draw_x_axis(page_, x_, kTop, kBottom, chart_.size_label);
    draw_y_axis(page_, y_, kLeft, kRight, "defects found where the line looks (%)");
    for (std::size_t i = 0; i < chart_.curves.size(); ++i) {
      band(i);
    }
    page_.line({kLeft, y_.place(90.0)},
               {kRight, y_.place(90.0)},
               R"(stroke="#8a949e" stroke-dasharray="2 3")");
    for (std::size_t i = 0; i < chart_.curves.size(); ++i) {
      levels(i);
      curve(i);
    }
    sizes_at_90();
    for (std::size_t i = 0; i < chart_.curves.size(); ++i) {
      legend(i);
    }
    const double height = kBottom + 74.0 + 18.0 * static_cast<double>(chart_.curves.size());
    page_.text({kLeft, height - 10.0},
               fmt::format("Bars and bands: {:g} % confidence. Tips on the line of 90 %: a90, open "
                           "ones a90/95.",
                           100.0 * chart_.confidence),
               "start",
               0.0,
               R"(font-size="11")");
    return page_.document(kWidth, height, chart_.title);
  }

 private:
  static std::string_view colour(std::size_t i) { return kColours[i % kColours.size()]; }

  static Mark form(std::size_t i) { return kMarks[i % kMarks.size()]; }

  double size_at(int k) const {
    return x_.low * std::pow(x_.high / x_.low, static_cast<double>(k) / (kCurvePoints - 1));
  }

  void band(std::size_t i) {
    const auto& fit = chart_.curves[i].fit;
    if (!fit) {
      return;
    }
    std::vector<Vector2d> rim;
    std::vector<Vector2d> back;
    for (int k = 0; k < kCurvePoints; ++k) {
      const Estimate found = fit->at(size_at(k), chart_.confidence);
      rim.emplace_back(x_.place(size_at(k)), y_.place(100.0 * found.low));
      back.emplace_back(x_.place(size_at(k)), y_.place(100.0 * found.high));
    }
    rim.insert(rim.end(), back.rbegin(), back.rend());
    page_.shape("polygon", rim, fmt::format(R"(fill="{}" fill-opacity="0.16")", colour(i)));
  }

  void curve(std::size_t i) {
    const auto& fit = chart_.curves[i].fit;
    if (!fit) {
      return;
    }
    std::vector<Vector2d> points;
    for (int k = 0; k < kCurvePoints; ++k) {
      points.emplace_back(x_.place(size_at(k)),
                          y_.place(100.0 * fit->at(size_at(k), chart_.confidence).value));
    }
    page_.shape(
        "polyline", points, fmt::format(R"(fill="none" stroke="{}" stroke-width="2")", colour(i)));
  }

  /// Shares as they were counted; designs stand a little beside each other.
  void levels(std::size_t i) {
    const double aside =
        5.0 * (static_cast<double>(i) - 0.5 * static_cast<double>(chart_.curves.size() - 1));
    const std::string style = fmt::format(R"(stroke="{}" stroke-width="1.2")", colour(i));
    for (const PodLevel& level : chart_.curves[i].levels) {
      const double x = x_.place(level.size) + aside;
      page_.line(
          {x, y_.place(100.0 * level.share.low)}, {x, y_.place(100.0 * level.share.high)}, style);
      draw_mark(page_, {x, y_.place(100.0 * level.share.value)}, form(i), colour(i), true, 3.4);
    }
  }

  void tip(double size, std::size_t i, bool is_open) {
    if (!(size >= x_.low && size <= x_.high)) {
      return;
    }
    const double x = x_.place(size);
    const double y = y_.place(90.0);
    page_.shape("polygon",
                {Vector2d(x, y), Vector2d(x - 4.5, y + 10.0), Vector2d(x + 4.5, y + 10.0)},
                fmt::format(R"(fill="{}" stroke="{}" stroke-width="1.2")",
                            is_open ? "#ffffff" : colour(i),
                            colour(i)));
  }

  /// The open tips first: of two at one place the filled one is seen.
  void sizes_at_90() {
    for (const bool is_open : {true, false}) {
      for (std::size_t i = 0; i < chart_.curves.size(); ++i) {
        if (const auto& fit = chart_.curves[i].fit) {
          tip(is_open ? fit->a90_95 : fit->a90.value, i, is_open);
        }
      }
    }
  }

  std::string size_text(double size) const {
    double most = 0.0;
    for (const PodCurve& curve : chart_.curves) {
      for (const PodLevel& level : curve.levels) {
        most = std::max(most, level.size);
      }
    }
    return size <= most ? fmt::format("{:.3g} {}", size, chart_.unit)
                        : fmt::format("above {:.3g} {}", most, chart_.unit);
  }

  void legend(std::size_t i) {
    const double y = kBottom + 64.0 + 18.0 * static_cast<double>(i);
    const PodCurve& curve = chart_.curves[i];
    page_.line({kLeft - 8.0, y - 4.0},
               {kLeft + 16.0, y - 4.0},
               fmt::format(R"(stroke="{}" stroke-width="2")", colour(i)));
    draw_mark(page_, {kLeft + 4.0, y - 4.0}, form(i), colour(i), true, 3.4);
    page_.text({kLeft + 24.0, y}, curve.title, "start");
    page_.text({kLeft + 330.0, y},
               curve.fit ? fmt::format("a90 {},  a90/95 {}",
                                       size_text(curve.fit->a90.value),
                                       size_text(curve.fit->a90_95))
                         : "no curve: found shares do not rise with size",
               "start");
  }

  const PodChart& chart_;
  SvgPage page_;
  ChartAxis x_;
  ChartAxis y_;
};

}  // namespace

std::string pod_svg(const PodChart& chart) {
  return PodDrawing(chart).draw();
}

}  // namespace glint

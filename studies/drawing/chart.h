// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "studies/drawing/svg_page.h"

namespace glint {

/// An axis of a chart: values to positions along the page.
struct ChartAxis {
  enum class Scale { kLinear, kRoot, kLog };  ///< kRoot: by square roots, begins at 0

  Scale scale = Scale::kLinear;
  double low = 0.0;  ///< kLog: > 0
  double high = 1.0;
  double from = 0.0;  ///< position of low
  double to = 1.0;    ///< position of high

  /// Values beyond the ends, also infinite ones, are put at the ends.
  double place(double value) const;

  /// Round values from low to high whose positions are at least that far apart: multiples of 1, 2
  /// or 5 times a power of ten, or these numbers themselves where the scale is not even.
  std::vector<double> ticks(double least_gap) const;
};

/// The next number at or above it that is 1, 2 or 5 times a power of ten. @param value  > 0
double round_above(double value);

/// "0", "0.5", "200", "20000"
std::string tick_text(double value);

inline constexpr std::string_view kGridStyle = R"(stroke="#dde2e6" stroke-width="1")";

enum class Mark { kCircle, kSquare, kTriangle, kDiamond };

/// A mark of one area whatever its form; open ones are filled with white.
void draw_mark(SvgPage& page,
               const Eigen::Vector2d& at,
               Mark form,
               std::string_view colour,
               bool is_open = false,
               double radius = 4.5);

/// Grid lines, tick texts and the words of an axis along the bottom of the box from (left, top) to
/// (right, bottom), or of one along its left side.
void draw_x_axis(
    SvgPage& page, const ChartAxis& axis, double top, double bottom, std::string_view words);
void draw_y_axis(
    SvgPage& page, const ChartAxis& axis, double left, double right, std::string_view words);

}  // namespace glint

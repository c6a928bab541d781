// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/text.h"
#include "core/units.h"

namespace glint {
namespace {

constexpr std::array<double, 3> kSteps = {1.0, 2.0, 5.0};

/// Keeps the values that stand far enough from the one kept before.
std::vector<double> spread(const std::vector<double>& values, const ChartAxis& axis, double gap) {
  std::vector<double> kept;
  for (const double value : values) {
    if (kept.empty() || std::abs(axis.place(value) - axis.place(kept.back())) >= gap) {
      kept.push_back(value);
    }
  }
  return kept;
}

/// The value with the digits that a person would write.
double cleaned(double value, double step) {
  const double rounded = std::round(value / step) * step;
  const double digits = std::pow(10.0, std::ceil(2.0 - std::log10(step)));
  return std::round(rounded * digits) / digits + 0.0;  // never -0
}

std::vector<double> even_ticks(const ChartAxis& axis, double least_gap) {
  const double length = std::abs(axis.to - axis.from);
  const double step = round_above((axis.high - axis.low) * std::min(1.0, least_gap / length));
  std::vector<double> values;
  for (double k = std::ceil(axis.low / step - 1e-9); k * step <= axis.high + 1e-9 * step;
       k += 1.0) {
    values.push_back(cleaned(k * step, step));
  }
  return values;
}

/// 1, 2 and 5 times powers of ten. Powers of ten alone where there is no room for all of them.
std::vector<double> uneven_ticks(const ChartAxis& axis, double least_gap) {
  const bool is_log = axis.scale == ChartAxis::Scale::kLog;
  const double first = is_log ? axis.low : axis.high * 1e-4;
  std::vector<double> all;
  std::vector<double> powers;
  for (double power = std::floor(std::log10(first)); power <= std::log10(axis.high); power += 1.0) {
    for (const double step : kSteps) {
      const double unit = std::pow(10.0, power);
      const double value = cleaned(step * unit, unit);
      if (value >= first * (1.0 - 1e-9) && value <= axis.high * (1.0 + 1e-9)) {
        all.push_back(value);
        if (step == 1.0) {
          powers.push_back(value);
        }
      }
    }
  }
  if (!is_log) {
    all.insert(all.begin(), 0.0);
    return spread(all, axis, least_gap);
  }
  const std::vector<double> kept = spread(all, axis, least_gap);
  const std::vector<double> kept_powers = spread(powers, axis, least_gap);
  return kept.size() == all.size() || kept_powers.size() < 2 ? kept : kept_powers;
}

using Eigen::Vector2d;

constexpr double kLeastGap = 34.0;

}  // namespace

double ChartAxis::place(double value) const {
  const double kept = std::clamp(value, low, high);
  double share = 0.0;
  switch (scale) {
    case Scale::kLinear:
      share = (kept - low) / (high - low);
      break;
    case Scale::kRoot:
      share = std::sqrt(kept / high);
      break;
    case Scale::kLog:
      share = std::log(kept / low) / std::log(high / low);
      break;
  }
  return from + (to - from) * share;
}

std::vector<double> ChartAxis::ticks(double least_gap) const {
  return scale == Scale::kLinear ? even_ticks(*this, least_gap) : uneven_ticks(*this, least_gap);
}

double round_above(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : kSteps) {
    if (step * power >= value * (1.0 - 1e-9)) {
      return step * power;
    }
  }
  return 10.0 * power;
}

std::string tick_text(double value) {
  return shortest(value);
}

void draw_mark(SvgPage& page,
               const Vector2d& at,
               Mark form,
               std::string_view colour,
               bool is_open,
               double radius) {
  struct Corners {
    int count;
    double turn_rad;
    double scale;  ///< of the radius, for equal areas
  };

  constexpr std::array<Corners, 4> kForms = {
      {{24, 0.0, 1.0}, {4, 0.25 * kPi, 1.25}, {3, -0.5 * kPi, 1.55}, {4, 0.0, 1.25}}};
  const Corners& form_of = kForms[static_cast<std::size_t>(form)];
  std::vector<Vector2d> corners;
  for (int i = 0; i < form_of.count; ++i) {
    const double angle_rad = form_of.turn_rad + 2.0 * kPi * i / form_of.count;
    corners.emplace_back(at + form_of.scale * radius *
                                  Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
  }
  page.shape(
      "polygon",
      corners,
      fmt::format(
          R"(fill="{}" stroke="{}" stroke-width="1.3")", is_open ? "#ffffff" : colour, colour));
}

void draw_x_axis(
    SvgPage& page, const ChartAxis& axis, double top, double bottom, std::string_view words) {
  for (const double value : axis.ticks(kLeastGap)) {
    const double x = axis.place(value);
    page.line({x, top}, {x, bottom}, kGridStyle);
    page.text({x, bottom + 17.0}, tick_text(value));
  }
  page.text({0.5 * (axis.from + axis.to), bottom + 38.0}, words);
}

void draw_y_axis(
    SvgPage& page, const ChartAxis& axis, double left, double right, std::string_view words) {
  for (const double value : axis.ticks(0.7 * kLeastGap)) {
    const double y = axis.place(value);
    page.line({left, y}, {right, y}, kGridStyle);
    page.text({left - 7.0, y + 4.0}, tick_text(value), "end");
  }
  page.text({left - 48.0, 0.5 * (axis.from + axis.to)}, words, "middle", -90.0);
}

}  // namespace glint

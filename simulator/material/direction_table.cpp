// SPDX-License-Identifier: GPL-3.0-or-later
//
// A function of direction that depends on the azimuth through the width of the slopes along it
// alone. Rows lie in even steps of log(1 + z / knee), since such functions fall like z log(z) at
// grazing; columns in even steps of the width. Between them it is interpolated by Catmull-Rom's
// cubics, which extrapolate the missing node at the ends. Cost: 4 reads, 16 with unequal widths.
// docs/theory/materials.md
#include "simulator/material/direction_table.h"

#include "simulator/material/quadrature.h"

namespace glint {
namespace {

constexpr int kRows = DirectionTable::kRows;
constexpr int kColumns = 10;

/// Width of the slopes along the azimuth of a direction.
double width_at(const GgxAlpha<double>& alpha, const LocalDirection& v) {
  const double radius2 = v.x * v.x + v.y * v.y;
  if (alpha.x == alpha.y || radius2 < 1e-24) {
    return alpha.x;
  }
  const double x = alpha.x * v.x;
  const double y = alpha.y * v.y;
  return std::sqrt((x * x + y * y) / radius2);
}

/// The direction of a cosine, in the azimuth where the slopes have that width.
LocalDirection direction_of(const GgxAlpha<double>& alpha, double width, double mu) {
  const double radius = std::sqrt(std::max(0.0, 1.0 - mu * mu));
  const double x2 = alpha.x * alpha.x;
  const double y2 = alpha.y * alpha.y;
  const double sin2 = x2 == y2 ? 0.0 : std::clamp((width * width - x2) / (y2 - x2), 0.0, 1.0);
  return {radius * std::sqrt(1.0 - sin2), radius * std::sqrt(sin2), mu};
}

/// Where the rows begin to spread: the functions fall like z log(z) at grazing.
double knee_of(const GgxAlpha<double>& alpha) {
  const double narrow = std::min(alpha.x, alpha.y);
  const double wide = std::max(alpha.x, alpha.y);
  return 0.03 * std::min(narrow, 1.0 / wide);
}

/// Weights of the four neighbours of a place between the second and the third (Catmull-Rom).
/// @param t  in [0, 1]
std::array<double, 4> cubic_weights(double t) {
  return {0.5 * t * ((2.0 - t) * t - 1.0),
          0.5 * ((3.0 * t - 5.0) * t * t + 2.0),
          0.5 * t * ((4.0 - 3.0 * t) * t + 1.0),
          0.5 * t * t * (t - 1.0)};
}

}  // namespace

CubicStencil cubic_stencil(double x, int count) {
  const double place = std::clamp(x, 0.0, static_cast<double>(count - 1));
  const int cell = std::min(static_cast<int>(place), count - 2);
  const std::array<double, 4> w = cubic_weights(place - cell);
  if (cell == 0) {  // the node before the first: 3 a - 3 b + c
    return {.first = 0, .weights = {w[1] + 3.0 * w[0], w[2] - 3.0 * w[0], w[3] + w[0], 0.0}};
  }
  if (cell == count - 2) {
    return {.first = count - 4,
            .weights = {0.0, w[0] + w[3], w[1] - 3.0 * w[3], w[2] + 3.0 * w[3]}};
  }
  return {.first = cell - 1, .weights = w};
}

DirectionTable::DirectionTable(const GgxAlpha<double>& alpha, const Function& function)
    : alpha_(alpha),
      columns_(alpha.x == alpha.y ? 1 : kColumns),
      knee_(knee_of(alpha)),
      scale_(std::log(1.0 + 1.0 / knee_)) {
  for (int c = 0; c < columns_; ++c) {
    const double share = columns_ == 1 ? 0.0 : static_cast<double>(c) / (columns_ - 1);
    const double width = alpha.x + (alpha.y - alpha.x) * share;
    for (int r = 0; r < kRows; ++r) {
      const double mu = z_of(static_cast<double>(r) / (kRows - 1));
      values_.push_back(function(direction_of(alpha, width, mu)));
    }
  }
  average_ = integrate();
}

double DirectionTable::z_of(double u) const {
  return std::min(1.0, knee_ * std::expm1(u * scale_));
}

double DirectionTable::value(int column, double u) const {
  const CubicStencil row = cubic_stencil(u * (kRows - 1), kRows);
  const double* v = &values_[static_cast<std::size_t>(column * kRows + row.first)];
  return row.weights[0] * v[0] + row.weights[1] * v[1] + row.weights[2] * v[2] +
         row.weights[3] * v[3];
}

double DirectionTable::column_at(double width) const {
  return (width - alpha_.x) / (alpha_.y - alpha_.x) * (columns_ - 1);
}

double DirectionTable::at(const LocalDirection& direction) const {
  const double z = std::clamp(direction.z, 0.0, 1.0);
  const double u = std::log(1.0 + z / knee_) / scale_;
  if (columns_ == 1) {
    return value(0, u);
  }
  const CubicStencil column = cubic_stencil(column_at(width_at(alpha_, direction)), columns_);
  double sum = 0.0;
  for (int c = 0; c < 4; ++c) {
    sum += column.weights[static_cast<std::size_t>(c)] * value(column.first + c, u);
  }
  return sum;
}

double DirectionTable::integrate() const {
  const Quadrature rule = gauss_legendre(48);
  const int azimuths = columns_ == 1 ? 1 : 64;  // midpoints of a quarter turn
  double sum = 0.0;
  for (int a = 0; a < azimuths; ++a) {
    const double phi_rad = 0.5 * kPi * (a + 0.5) / azimuths;
    const LocalDirection along = {std::cos(phi_rad), std::sin(phi_rad), 0.0};
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double mu = z_of(rule.nodes[i]);
      const double slope = (mu + knee_) * scale_;
      const double radius = std::sqrt(std::max(0.0, 1.0 - mu * mu));
      sum += rule.weights[i] * 2.0 * mu * slope * at({radius * along.x, radius * along.y, mu});
    }
  }
  return sum / azimuths;
}

}  // namespace glint

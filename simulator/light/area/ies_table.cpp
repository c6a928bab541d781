// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/ies_table.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace glint {
namespace {

/// A place between two neighbours of a rising table.
struct Between {
  std::size_t low = 0;
  double share = 0.0;  ///< of the upper neighbour
};

Between find_between(const std::vector<double>& table, double value) {
  const auto above = std::upper_bound(table.begin() + 1, table.end() - 1, value);
  const auto low = static_cast<std::size_t>(above - table.begin()) - 1;
  const double share = (value - table[low]) / (table[low + 1] - table[low]);
  return {.low = low, .share = std::clamp(share, 0.0, 1.0)};
}

/// The integral of f0 + (f1 - f0) (x - x0) / (x1 - x0) times sin x over [x0, x1].
double sine_integral(double x0, double x1, double f0, double f1) {
  const double whole = std::cos(x0) - std::cos(x1);
  // of (x - x0) sin x
  const double first = std::sin(x1) - std::sin(x0) - (x1 - x0) * std::cos(x1);
  return f0 * whole + (f1 - f0) * first / (x1 - x0);
}

}  // namespace

double IesTable::at(const Eigen::Vector3d& direction) const {
  const double vertical = std::acos(std::clamp(direction.z(), -1.0, 1.0));
  // Rounding may carry the ends of the range out of it.
  constexpr double kRounding_rad = 1e-9;
  if (vertical < vertical_rad.front() - kRounding_rad ||
      vertical > vertical_rad.back() + kRounding_rad) {
    return 0.0;
  }
  const Between v = find_between(vertical_rad, vertical);
  const auto along = [&](std::size_t plane) {
    const double* row = intensity.data() + plane * vertical_rad.size() + v.low;
    return row[0] + v.share * (row[1] - row[0]);
  };
  if (horizontal_rad.size() == 1) {
    return along(0);
  }
  // Seen from behind, with z away from the viewer, counterclockwise runs from x to -y.
  double horizontal = std::atan2(-direction.y(), direction.x());
  horizontal += horizontal < 0.0 ? 2.0 * kPi : 0.0;
  const Between h = find_between(horizontal_rad, horizontal);
  const double low = along(h.low);
  return low + h.share * (along(h.low + 1) - low);
}

double IesTable::flux() const {
  const std::size_t n = vertical_rad.size();
  const auto plane_integral = [&](std::size_t plane) {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const double* row = intensity.data() + plane * n + i;
      sum += sine_integral(vertical_rad[i], vertical_rad[i + 1], row[0], row[1]);
    }
    return sum;
  };
  if (horizontal_rad.size() == 1) {
    return 2.0 * kPi * plane_integral(0);
  }
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < horizontal_rad.size(); ++k) {
    sum += 0.5 * (plane_integral(k) + plane_integral(k + 1)) *
           (horizontal_rad[k + 1] - horizontal_rad[k]);
  }
  return sum;
}

double IesTable::highest() const {
  return *std::max_element(intensity.begin(), intensity.end());
}

}  // namespace glint

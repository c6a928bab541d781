// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/distinct_stripes.h"

#include <cmath>
#include <utility>

namespace glint {
namespace {

constexpr double kTolerance = 1e-9;  // periods

/// True when stripes have moved by the same part of a period.
bool is_same_place(double a_periods, double b_periods) {
  const double apart = a_periods - b_periods;
  return std::abs(apart - std::round(apart)) < kTolerance;
}

}  // namespace

DistinctStripes::DistinctStripes(std::vector<double> shifts) : shift_periods(std::move(shifts)) {
  for (std::size_t k = 0; k < shift_periods.size(); ++k) {
    frames.push_back({.source = k});
  }
}

/// In even steps the first frame that is opposite to another one is opposite to the first of all.
DistinctStripes::DistinctStripes(const std::vector<double>& shifts, double duty) {
  const bool has_opposites = std::abs(duty - 0.5) < kTolerance;
  const auto find = [&](double shift) {
    std::size_t source = 0;
    while (source < shift_periods.size() && !is_same_place(shift_periods[source], shift)) {
      ++source;
    }
    return source;
  };
  for (const double shift : shifts) {
    const std::size_t next = shift_periods.size();
    const std::size_t same = find(shift);
    const std::size_t opposite = has_opposites ? find(shift + 0.5) : next;
    if (same < next) {
      frames.push_back({.source = same});
    } else if (opposite < next && opposite_of_first > 0) {
      frames.push_back({.source = opposite, .is_opposite = true});
    } else {
      opposite_of_first = opposite == 0 && next > 0 ? next : opposite_of_first;
      frames.push_back({.source = next});
      shift_periods.push_back(shift);
    }
  }
}

void DistinctStripes::expand(const double* of_sources, std::vector<float>& values) const {
  const double both = of_sources[0] + of_sources[opposite_of_first];
  for (const Frame& frame : frames) {
    const double radiance = of_sources[frame.source];
    values.push_back(static_cast<float>(frame.is_opposite ? both - radiance : radiance));
  }
}

}  // namespace glint

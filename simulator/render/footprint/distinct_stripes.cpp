// SPDX-License-Identifier: GPL-3.0-or-later
//
// Frames in even steps come back to the first one after `period` frames and, at duty 1/2, to its
// opposite after `half`; both are found by comparing shifts to 1e-9 of a period, and every later
// frame is a copy, or the sum of the two opposites less a frame. At duty 1/2 it halves what is
// integrated. docs/theory/footprints.md
#include "simulator/render/footprint/distinct_stripes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace glint {
namespace {

constexpr double kTolerance = 1e-9;  // periods

/// The first frame whose stripes lie `apart` of a period from those of frame 0; none: their number.
std::size_t first_at(const std::vector<double>& shifts, double apart_periods) {
  std::size_t k = 1;
  const auto is_there = [&](double shift) {
    const double off = shift - shifts.front() - apart_periods;
    return std::abs(off - std::round(off)) < kTolerance;
  };
  while (k < shifts.size() && !is_there(shifts[k])) {
    ++k;
  }
  return k;
}

}  // namespace

DistinctStripes::DistinctStripes(std::vector<double> shifts) : shift_periods(std::move(shifts)) {
  for (std::size_t k = 0; k < shift_periods.size(); ++k) {
    frames.push_back({.source = k});
  }
}

/// In even steps frames repeat themselves after as many as it takes to come back to frame 0, and
/// are opposite to those as long before them as it takes to frame 0's opposite.
DistinctStripes::DistinctStripes(const std::vector<double>& shifts, double duty) {
  const std::size_t period = first_at(shifts, 0.0);
  const bool has_opposites = std::abs(duty - 0.5) < kTolerance;
  const std::size_t half = has_opposites ? first_at(shifts, 0.5) : shifts.size();
  opposite_of_first = half < shifts.size() ? half : 0;
  const std::size_t sources = std::min({shifts.size(), period, half + 1});
  shift_periods.assign(shifts.begin(), shifts.begin() + static_cast<std::ptrdiff_t>(sources));
  for (std::size_t k = 0; k < shifts.size(); ++k) {
    const std::size_t place = k % period;
    const bool is_opposite = place > half;
    frames.push_back({.source = is_opposite ? place - half : place, .is_opposite = is_opposite});
  }
}

void DistinctStripes::expand(const double* of_sources, std::vector<float>& values) const {
  const double both = of_sources[0] + of_sources[opposite_of_first];
  const std::size_t before = values.size();
  values.resize(before + frames.size());
  float* out = values.data() + before;
  for (const Frame& frame : frames) {
    const double radiance = of_sources[frame.source];
    *out++ = static_cast<float>(frame.is_opposite ? both - radiance : radiance);
  }
}

}  // namespace glint

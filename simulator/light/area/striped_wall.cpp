// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/striped_wall.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace glint {

int StripedWall::bin_at(double phase) const {
  // The last bin takes what rounding puts at 1.
  const auto end = std::upper_bound(bin_ends.begin(), bin_ends.end() - 1, phase);
  return static_cast<int>(end - bin_ends.begin());
}

namespace {

/// A number in [0, 1) that looks random from one place to the next (the finaliser of SplitMix64,
/// G. Steele et al., "Fast splittable pseudorandom number generators", OOPSLA 2014).
double scattered(const Eigen::Vector3d& point_mm) {
  std::uint64_t bits = 0;
  for (const double coordinate : point_mm) {
    bits = (bits ^ std::bit_cast<std::uint64_t>(coordinate)) + 0x9e3779b97f4a7c15U;
    bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9U;
    bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebU;
    bits ^= bits >> 31U;
  }
  return static_cast<double>(bits >> 11U) * 0x1.0p-53;
}

}  // namespace

bool StripedWall::is_second(std::size_t wall_emitter, const Eigen::Vector3d& point_mm) const {
  if (second_share.empty()) {
    return false;
  }
  const double from_middle_mm = along[wall_emitter].dot(point_mm - middle_mm[wall_emitter]);
  return scattered(point_mm) <
         second_share[wall_emitter] + second_share_per_mm[wall_emitter] * from_middle_mm;
}

int StripedWall::group_at(int emitter, const Eigen::Vector3d& point_mm) const {
  const auto i = static_cast<std::size_t>(emitter - first_emitter);
  double periods = point_mm.x() * periods_per_x_mm - offset_periods;
  if (periods_per_arc_mm != 0.0) {
    const double arc_mm = middle_arc_mm[i] + along[i].dot(point_mm - middle_mm[i]);
    periods += arc_mm * periods_per_arc_mm;
  }
  const int set = is_second(i, point_mm) ? static_cast<int>(bin_ends.size()) : 0;
  return first_group + set + bin_at(periods - std::floor(periods));
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/striped_wall.h"

#include <algorithm>
#include <cmath>

namespace glint {

int StripedWall::bin_at(double phase) const {
  // The last bin takes what rounding puts at 1.
  const auto end = std::upper_bound(bin_ends.begin(), bin_ends.end() - 1, phase);
  return static_cast<int>(end - bin_ends.begin());
}

int StripedWall::group_at(int emitter, const Eigen::Vector3d& point_mm) const {
  const auto i = static_cast<std::size_t>(emitter - first_emitter);
  double periods = point_mm.x() * periods_per_x_mm - offset_periods;
  if (periods_per_arc_mm != 0.0) {
    const double arc_mm = middle_arc_mm[i] + along[i].dot(point_mm - middle_mm[i]);
    periods += arc_mm * periods_per_arc_mm;
  }
  return first_group + bin_at(periods - std::floor(periods));
}

}  // namespace glint

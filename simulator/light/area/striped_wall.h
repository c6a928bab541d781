// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

namespace glint {

/// The emitters that are a tunnel's wall, and which of its light groups a point of it belongs to:
/// the bin of its phase, which is where it lies within a period of the stripes.
struct StripedWall {
  int first_emitter = 0;              ///< its rectangles follow one another among the emitters ...
  std::vector<double> middle_arc_mm;  ///< ... of each: along the cross-section, at its centre
  std::vector<Eigen::Vector3d> middle_mm;  ///< centre
  std::vector<Eigen::Vector3d> along;      ///< unit, along the cross-section
  int first_group = 0;
  std::vector<double> bin_ends = {1.0};  ///< of each bin: where it ends, rising, the last is 1
  double periods_per_x_mm = 0.0;         ///< phase = x ... + arc ... - offset, without whole turns
  double periods_per_arc_mm = 0.0;
  double offset_periods = 0.0;
  // Where the light of dark stripes depends on the place there are as many groups again, and a
  // place belongs to one of the second set with this probability; empty: there are none.
  std::vector<double> second_share;         ///< of each emitter, at its centre ...
  std::vector<double> second_share_per_mm;  ///< ... and along the cross-section

  bool has(int emitter) const {
    return emitter >= first_emitter &&
           emitter < first_emitter + static_cast<int>(middle_arc_mm.size());
  }

  /// @param phase  in [0, 1) @return from 0
  int bin_at(double phase) const;

  /// True when the point belongs to the second set: the same for the same point.
  bool is_second(std::size_t wall_emitter, const Eigen::Vector3d& point_mm) const;

  /// The light group of a point on one of the wall's emitters.
  int group_at(int emitter, const Eigen::Vector3d& point_mm) const;
};

}  // namespace glint

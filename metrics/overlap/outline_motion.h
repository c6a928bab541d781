// SPDX-License-Identifier: GPL-3.0-or-later
//
// How an outline is moved as a whole: shift, turn, scale and shear from what its points tell along
// their normals.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "metrics/overlap/boundary.h"
#include "metrics/overlap/ring_offsets.h"

namespace glint {

/// at -> at + shift + linear (at - middle).
struct OutlineMotion {
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
  Eigen::Matrix2d linear = Eigen::Matrix2d::Zero();
  /// Unit vector along which the edges tell no shift, as they all run that way: the shift along it
  /// is 0. Zero: they tell both directions.
  Eigen::Vector2d untold = Eigen::Vector2d::Zero();

  bool is_shift_told() const { return untold.isZero(0.0); }

  Eigen::Vector2d moved(const Eigen::Vector2d& at_px) const {
    return at_px + shift_px + linear * (at_px - middle_px);
  }
};

/// The motion that most offsets agree upon (Tukey's biweight from the median; those beyond about
/// three robust standard deviations do not count). Fewer than 12 offsets: a shift alone. Turn,
/// scale, stretch and shear stay 0 where the edges do not tell them: no scale of a part of which
/// one corner shows, no turn of a circle. So does the shift along straight sides that are parallel
/// to each other, where nothing else shows (`untold`).
/// @param min_scale_px    offsets apart by less are alike, > 0
/// @param is_shift_only   turn, scale and shear stay 0
OutlineMotion fit_outline_motion(std::span<const EdgeOffset> offsets,
                                 double min_scale_px,
                                 bool is_shift_only = false);

/// Outlines after a motion; normals stay.
std::vector<Boundary> moved_outlines(std::vector<Boundary> outlines, const OutlineMotion& motion);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a calibration by rounds aims at, and whether it goes on after one of them.
#pragma once

#include <functional>
#include <string>

namespace glint::calibrate_cell_detail {

/// What is good enough; 0: not asked for.
struct RoundTargets {
  double point_px = 0.3;     ///< of the point error, one sigma of a computed point
  double hand_eye_mm = 0.0;  ///< of the hand-eye's stated sigma
  double hand_eye_deg = 0.0;
  int max_rounds = 4;
};

/// What a calibration tells after a round.
struct RoundErrors {
  double point_px = 0.0;
  double hand_eye_mm = 0.0;
  double hand_eye_deg = 0.0;
};

/// The largest of the errors in units of what is asked for; at most 1: good enough.
double missed_by(const RoundErrors& errors, const RoundTargets& targets);

/// @param round   counted from 1
/// @param missed  missed_by() after it
/// @param before  the same after the round before it
/// @param promised  tells what missed_by() the poses of the next round promise; asked only where
///                  pictures have hardly helped
/// @return "good", "no_pose_helps" (better by less than a tenth, which would not do in all rounds
///         that are left either, and the next poses promise hardly anything), "most_rounds"; empty:
///         another round is to follow
std::string status_after_round(int round,
                               double missed,
                               double before,
                               int max_rounds,
                               const std::function<double()>& promised);

}  // namespace glint::calibrate_cell_detail

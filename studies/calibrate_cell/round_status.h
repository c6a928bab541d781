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

/// Whether a target of the hand-eye is missed by more than that of the point error: then the next
/// poses are chosen for the hand-eye, else for all unknowns alike.
bool is_hand_eye_worst(const RoundErrors& errors, const RoundTargets& targets);

/// What missed_by() the next poses promise.
/// @param was_for_hand_eye  whether the poses of the last round were chosen for the hand-eye
/// @param is_for_hand_eye   whether those of the next one are
/// @param missed   missed_by() now
/// @param planned  tells it from a plan for the hand-eye
/// @return `missed` for poses that are chosen for the point error, of which no plan tells; 0 where
///         no pictures of such poses have been tried yet
double promise_of(bool was_for_hand_eye,
                  bool is_for_hand_eye,
                  double missed,
                  const std::function<double()>& planned);

/// @param round   counted from 1
/// @param missed  missed_by() after it
/// @param before  the same after the round before it
/// @param promised  tells what missed_by() the poses of the next round promise; asked only where
///                  pictures have hardly helped and a round is left
/// @return "good", "max_rounds", "no_pose_helps" (better by less than a tenth, which would not do
///         in all rounds that are left either, and the next poses promise hardly anything); empty:
///         another round is to follow
std::string status_after_round(int round,
                               double missed,
                               double before,
                               int max_rounds,
                               const std::function<double()>& promised);

}  // namespace glint::calibrate_cell_detail

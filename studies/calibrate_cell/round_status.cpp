// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/round_status.h"

#include <algorithm>
#include <cmath>

namespace glint::calibrate_cell_detail {
namespace {

constexpr double kWorthIt = 0.9;  ///< of the error before: less is worth another round
constexpr double kHelps = 0.97;   ///< of the error now: poses that promise less help

double share_of(double error, double target) {
  return target > 0.0 ? error / target : 0.0;
}

double hand_eye_missed_by(const RoundErrors& errors, const RoundTargets& targets) {
  return std::max(share_of(errors.hand_eye_mm, targets.hand_eye_mm),
                  share_of(errors.hand_eye_deg, targets.hand_eye_deg));
}

}  // namespace

double missed_by(const RoundErrors& errors, const RoundTargets& targets) {
  return std::max(share_of(errors.point_px, targets.point_px), hand_eye_missed_by(errors, targets));
}

bool is_hand_eye_worst(const RoundErrors& errors, const RoundTargets& targets) {
  return hand_eye_missed_by(errors, targets) > share_of(errors.point_px, targets.point_px);
}

double promise_of(bool was_for_hand_eye,
                  bool is_for_hand_eye,
                  double missed,
                  const std::function<double()>& planned) {
  if (is_for_hand_eye) {
    return planned();
  }
  return was_for_hand_eye ? 0.0 : missed;
}

std::string status_after_round(int round,
                               double missed,
                               double before,
                               int max_rounds,
                               const std::function<double()>& promised) {
  if (missed <= 1.0) {
    return "good";
  }
  if (round >= max_rounds) {
    return "max_rounds";
  }
  const double left = missed / before;
  const bool is_reached = left < 1.0 && missed * std::pow(left, max_rounds - round) <= 1.0;
  if (round > 1 && left > kWorthIt && !is_reached && promised() > kHelps * missed) {
    return "no_pose_helps";
  }
  return "";
}

}  // namespace glint::calibrate_cell_detail

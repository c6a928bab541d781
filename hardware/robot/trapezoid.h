// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint {

/// A motion along a length at constant acceleration, constant speed, constant deceleration; without
/// the middle part where the length is too short for the speed. Own derivation.
class Trapezoid {
 public:
  /// @param length        >= 0
  /// @param speed         > 0
  /// @param acceleration  > 0
  Trapezoid(double length, double speed, double acceleration);

  double duration_s() const { return 2.0 * ramp_s_ + cruise_s_; }

  /// Length that was covered at a time; 0 before, the whole length after the motion.
  double at(double time_s) const;

  /// Speed at a time; 0 before and after the motion.
  double speed_at(double time_s) const;

 private:
  double length_;
  double acceleration_;
  double peak_;  ///< speed that is reached
  double ramp_s_;
  double cruise_s_;
};

}  // namespace glint

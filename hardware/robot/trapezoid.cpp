// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/trapezoid.h"

#include <algorithm>
#include <cmath>

namespace glint {

Trapezoid::Trapezoid(double length, double speed, double acceleration)
    : length_(length),
      acceleration_(acceleration),
      peak_(std::min(speed, std::sqrt(length * acceleration))),
      ramp_s_(peak_ / acceleration),
      cruise_s_(peak_ > 0.0 ? std::max(0.0, (length - peak_ * ramp_s_) / peak_) : 0.0) {}

double Trapezoid::at(double time_s) const {
  const double duration = duration_s();
  if (time_s <= 0.0) {
    return 0.0;
  }
  if (time_s >= duration) {
    return length_;
  }
  if (time_s < ramp_s_) {
    return 0.5 * acceleration_ * time_s * time_s;
  }
  if (time_s < ramp_s_ + cruise_s_) {
    return peak_ * (time_s - 0.5 * ramp_s_);
  }
  const double left = duration - time_s;
  return length_ - 0.5 * acceleration_ * left * left;
}

double Trapezoid::speed_at(double time_s) const {
  const double to_an_end_s = std::min(time_s, duration_s() - time_s);
  return std::clamp(acceleration_ * to_an_end_s, 0.0, peak_);
}

}  // namespace glint

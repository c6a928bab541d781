// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint {

/// A stripe of `duty` of a period, bright from phase 0 on, blurred by a Gaussian of w periods and
/// repeated with period 1.
struct BlurredStripe {
  double duty = 0.5;
  double w = 0.0;

  double at(double phase) const;     ///< in [0, 1]
  double slope(double phase) const;  ///< by the phase; 0 for w = 0
  /// Integral from the stripe's middle, duty / 2, to a phase up to half a period further.
  double integral(double phase) const;
};

/// Mean over a period of min(1, offset + slope * stripe), exactly: the blurred stripe falls from
/// its middle to half a period beyond, so it is clipped up to one phase, and its integral is
/// closed.
/// @param slope   >= 0
/// @param offset  >= 0
double clipped_mean_of(const BlurredStripe& stripe, double slope, double offset);

}  // namespace glint

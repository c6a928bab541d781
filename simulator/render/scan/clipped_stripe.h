// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

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

/// A blurred stripe as a series of cosines around its middle: its mean `duty` and, since a Gaussian
/// takes exp(-2 (pi k w)^2) of the k-th, few terms where the blur is not narrow.
class StripeSeries {
 public:
  static constexpr int kMaxTerms = 40;

  struct Point {
    double value = 0.0;
    double slope = 0.0;     ///< by the phase
    double integral = 0.0;  ///< from the stripe's middle
  };

  /// @param smallest  of what the blur leaves of a term; later terms are left out
  StripeSeries(const BlurredStripe& stripe, double smallest);

  Point at(double phase) const;

  double duty() const { return duty_; }

  /// Amplitudes from k = 1 on.
  const double* terms() const { return terms_.data(); }

  int size() const { return size_; }

 private:
  double duty_;
  int size_ = 0;
  std::array<double, kMaxTerms> terms_ = {};
};

/// Mean over a period of min(1, offset + slope * stripe), exactly: the blurred stripe falls from
/// its middle to half a period beyond, so it is clipped up to one phase, and its integral is
/// closed.
/// @param slope   >= 0
/// @param offset  >= 0
double clipped_mean_of(const BlurredStripe& stripe, double slope, double offset);

}  // namespace glint

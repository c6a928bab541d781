// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/clipped_stripe.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace glint {
namespace {

/// Beyond so many sigmas an edge is complete: 1e-15 is left.
constexpr double kReach = 8.0;

double density(double x) {
  return std::exp(-0.5 * x * x) / std::sqrt(2.0 * kPi);
}

double share(double x) {
  if (x > kReach) {
    return 1.0;
  }
  return x < -kReach ? 0.0 : 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/// The integral of share() from minus infinity.
double integral_of_share(double x) {
  if (x > kReach) {
    return x;
  }
  return x < -kReach ? 0.0 : x * share(x) + density(x);
}

/// Sum over the stripes that reach a phase within [duty / 2, duty / 2 + 1 / 2] of f at the rising
/// edge less f at the falling one, as functions of the distance in w.
template <class Function>
double sum_of_edges(const BlurredStripe& stripe, double phase, const Function& f) {
  const int reach = static_cast<int>(std::ceil(kReach * stripe.w)) + 1;
  double sum = 0.0;
  for (int m = -reach; m <= reach; ++m) {
    sum += f((phase - m) / stripe.w) - f((phase - m - stripe.duty) / stripe.w);
  }
  return sum;
}

/// The phase, from the middle of the stripe on, where a falling stripe reaches a level.
double phase_of_level(const BlurredStripe& stripe, double level) {
  double low = 0.5 * stripe.duty;
  double high = low + 0.5;
  double phase = std::min(high, stripe.duty);
  for (int step = 0; step < 60 && high - low > 1e-14; ++step) {
    const double above = stripe.at(phase) - level;
    (above > 0.0 ? low : high) = phase;
    const double slope = stripe.slope(phase);
    const double newton = phase - above / slope;
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(next - phase) < 1e-15) {
      break;
    }
    phase = next;
  }
  return phase;
}

}  // namespace

double BlurredStripe::at(double phase) const {
  if (w <= 0.0) {
    return phase - std::floor(phase) < duty ? 1.0 : 0.0;
  }
  return sum_of_edges(*this, phase, share);
}

double BlurredStripe::slope(double phase) const {
  return w > 0.0 ? sum_of_edges(*this, phase, density) / w : 0.0;
}

double BlurredStripe::integral(double phase) const {
  const double middle = 0.5 * duty;
  if (w <= 0.0) {
    return std::min(phase, duty) - middle;
  }
  return w * (sum_of_edges(*this, phase, integral_of_share) -
              sum_of_edges(*this, middle, integral_of_share));
}

double clipped_mean_of(const BlurredStripe& stripe, double slope, double offset) {
  const double middle = 0.5 * stripe.duty;
  const double end = middle + 0.5;
  const double unclipped = offset + slope * stripe.duty;
  if (offset + slope * stripe.at(middle) <= 1.0) {
    return unclipped;
  }
  if (offset + slope * stripe.at(end) >= 1.0) {
    return 1.0;
  }
  const double from = stripe.w > 0.0 ? phase_of_level(stripe, (1.0 - offset) / slope) : stripe.duty;
  const double rest = offset * (end - from) + slope * (0.5 * stripe.duty - stripe.integral(from));
  return 2.0 * ((from - middle) + rest);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stripe blurred by a Gaussian, and the exact mean of min(1, offset + slope * stripe) over a
// period. From its middle to half a period further the blurred stripe only falls, so it is clipped
// up to a single phase, which Newton's method inside a bracket finds; what remains is a closed
// integral. Narrow blurs sum the error functions of the edges nearby, wide ones a cosine series of
// at most 14 terms, as a Gaussian damps the k-th by exp(-2 (pi k w)^2). Own derivation:
// docs/theory/clipped_mean.md. Cost: some evaluations of the wave per call; no memory.
#include "simulator/render/scan/clipped_stripe.h"

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

/// From this blur on a mean is taken from a series: it has at most 14 terms then, and a stripe
/// summed from its edges ever more.
constexpr double kExactSeriesFrom = 0.1;
constexpr double kSmallestExactTerm = 1e-17;

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

StripeSeries::StripeSeries(const BlurredStripe& stripe, double smallest) : duty_(stripe.duty) {
  // Of the k-th term the blur leaves q^(k^2), which is the term before times q^(2 k - 1).
  const double q = std::exp(-2.0 * kPi * kPi * stripe.w * stripe.w);
  const double cosine = std::cos(kPi * duty_);
  const double sine = std::sin(kPi * duty_);
  double left = q;
  double ratio = q * q * q;
  double c = cosine;
  double s = sine;
  while (size_ < kMaxTerms && left >= smallest) {
    terms_[static_cast<std::size_t>(size_)] = 2.0 / (kPi * (size_ + 1)) * s * left;
    ++size_;
    left *= ratio;
    ratio *= q * q;
    const double next = c * cosine - s * sine;
    s = s * cosine + c * sine;
    c = next;
  }
}

StripeSeries::Point StripeSeries::at(double phase) const {
  const double turn = 2.0 * kPi * (phase - 0.5 * duty_);
  const double cosine = std::cos(turn);
  const double sine = std::sin(turn);
  Point point = {.value = duty_, .integral = duty_ * (phase - 0.5 * duty_)};
  double c = cosine;
  double s = sine;
  for (int i = 0; i < size_; ++i) {
    const double k = 2.0 * kPi * (i + 1);
    const double term = terms_[static_cast<std::size_t>(i)];
    point.value += term * c;
    point.slope -= k * term * s;
    point.integral += term * s / k;
    const double next = c * cosine - s * sine;
    s = s * cosine + c * sine;
    c = next;
  }
  return point;
}

namespace {

/// A stripe by its edges, as StripeSeries has it.
struct StripeEdges {
  BlurredStripe stripe;

  StripeSeries::Point at(double phase) const {
    return {.value = stripe.at(phase), .slope = stripe.slope(phase)};
  }
};

double integral_of(const StripeSeries& wave, double phase) {
  return wave.at(phase).integral;
}

double integral_of(const StripeEdges& wave, double phase) {
  return wave.stripe.integral(phase);
}

/// The phase, from the middle of the stripe on, where a falling stripe reaches a level.
template <class Wave>
double phase_of_level(const Wave& wave, double duty, double level) {
  double low = 0.5 * duty;
  double high = low + 0.5;
  double phase = std::min(high, duty);
  for (int step = 0; step < 60 && high - low > 1e-14; ++step) {
    const StripeSeries::Point point = wave.at(phase);
    const double above = point.value - level;
    (above > 0.0 ? low : high) = phase;
    const double newton = phase - above / point.slope;
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    const double moved = std::abs(next - phase);
    phase = next;
    // The mean is stationary in this phase, and so close Newton's next step is below rounding.
    if (moved < 1e-9) {
      break;
    }
  }
  return phase;
}

template <class Wave>
double mean_of(const Wave& wave, const BlurredStripe& stripe, double slope, double offset) {
  const double middle = 0.5 * stripe.duty;
  const double end = middle + 0.5;
  if (offset + slope * wave.at(middle).value <= 1.0) {
    return offset + slope * stripe.duty;
  }
  if (offset + slope * wave.at(end).value >= 1.0) {
    return 1.0;
  }
  const double from =
      stripe.w > 0.0 ? phase_of_level(wave, stripe.duty, (1.0 - offset) / slope) : stripe.duty;
  const double rest = offset * (end - from) + slope * (middle - integral_of(wave, from));
  return 2.0 * ((from - middle) + rest);
}

}  // namespace

double clipped_mean_of(const BlurredStripe& stripe, double slope, double offset) {
  if (stripe.w >= kExactSeriesFrom) {
    return mean_of(StripeSeries(stripe, kSmallestExactTerm), stripe, slope, offset);
  }
  return mean_of(StripeEdges{stripe}, stripe, slope, offset);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Gauss-Legendre nodes by Newton's method on the three-term recurrence, from the start values
// cos(pi (i - 1/4) / (n + 1/2)). Source: W. Press et al., "Numerical recipes", 4.6. Cost: n^2
// operations, once a rule.
#include "simulator/material/quadrature.h"

#include <cmath>

#include "core/units.h"

namespace glint {
namespace {

struct Legendre {
  double value;
  double slope;
};

/// The polynomial of a degree and its derivative inside (-1, 1), by the three-term recurrence.
Legendre legendre(int degree, double x) {
  double previous = 1.0;
  double value = x;
  for (int k = 2; k <= degree; ++k) {
    const double next = ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k;
    previous = value;
    value = next;
  }
  return {.value = value, .slope = degree * (x * value - previous) / (x * x - 1.0)};
}

}  // namespace

Quadrature gauss_legendre(int count) {
  constexpr int kNewtonSteps = 8;  // from this start value the 5th changes nothing any more
  Quadrature rule;
  for (int i = 0; i < count; ++i) {
    double x = -std::cos(kPi * (i + 0.75) / (count + 0.5));
    for (int step = 0; step < kNewtonSteps; ++step) {
      const Legendre at = legendre(count, x);
      x -= at.value / at.slope;
    }
    const double slope = legendre(count, x).slope;
    rule.nodes.push_back(0.5 * (1.0 + x));
    rule.weights.push_back(1.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace glint

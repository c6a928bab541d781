// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/distortion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/LU>

namespace glint {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kNever = std::numeric_limits<double>::infinity();

/// d/dr of r (1 + k1 r^2 + k2 r^4 + k3 r^6) at s = r^2: where it is not positive the image folds.
double radial_slope(const std::array<double, 3>& k, double s) {
  return 1.0 + s * (3.0 * k[0] + s * (5.0 * k[1] + s * 7.0 * k[2]));
}

/// The positive s at which radial_slope() has an extremum, ascending.
std::vector<double> extrema(const std::array<double, 3>& k) {
  const double a = 21.0 * k[2];
  const double b = 10.0 * k[1];
  const double c = 3.0 * k[0];
  std::vector<double> found;
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant >= 0.0) {
    // Both roots without cancellation; a = 0 leaves one of them, b = 0 too none.
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    for (const double root : {q / a, c / q}) {
      if (std::isfinite(root) && root > 0.0) {
        found.push_back(root);
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Largest argument in [low, high] up to which a falling function stays positive.
template <class Function>
double bisect(double low, double high, const Function& function) {
  for (int step = 0; step < 200; ++step) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) {
      break;
    }
    (function(middle) > 0.0 ? low : high) = middle;
  }
  return low;
}

/// The determinant of the Jacobian at radius r in the worst direction.
///
/// With t = (p2, p1), tau = |t|, c the cosine between the point and t, R the radial factor and
/// S = d(r R)/dr, the determinant is (S + 6 r tau c) (R + 2 r tau c) - 4 r^2 tau^2 (1 - c^2): a
/// convex parabola in c, so its minimum over [-1, 1] is known.
double worst_determinant(const Distortion& distortion, double r) {
  const auto& k = distortion.radial;
  const double s = r * r;
  const double factor = 1.0 + s * (k[0] + s * (k[1] + s * k[2]));
  const double slope = radial_slope(k, s);
  const double push = r * std::hypot(distortion.tangential[0], distortion.tangential[1]);
  const double c =
      push > 0.0 ? std::clamp(-(6.0 * factor + 2.0 * slope) / (32.0 * push), -1.0, 1.0) : -1.0;
  return (slope + 6.0 * push * c) * (factor + 2.0 * push * c) - 4.0 * push * push * (1.0 - c * c);
}

}  // namespace

Vector2d distort(const Distortion& distortion, const Vector2d& undistorted, Matrix2d* jacobian) {
  const auto& [k1, k2, k3] = distortion.radial;
  const auto& [p1, p2] = distortion.tangential;
  const double x = undistorted.x();
  const double y = undistorted.y();
  const double s = x * x + y * y;
  const double radial = 1.0 + s * (k1 + s * (k2 + s * k3));
  if (jacobian != nullptr) {
    const double d_radial = k1 + s * (2.0 * k2 + s * 3.0 * k3);  // with respect to s
    *jacobian << radial + 2 * x * x * d_radial + 2 * p1 * y + 6 * p2 * x,
        2 * x * y * d_radial + 2 * p1 * x + 2 * p2 * y,
        2 * x * y * d_radial + 2 * p1 * x + 2 * p2 * y,
        radial + 2 * y * y * d_radial + 6 * p1 * y + 2 * p2 * x;
  }
  return {x * radial + 2 * p1 * x * y + p2 * (s + 2 * x * x),
          y * radial + p1 * (s + 2 * y * y) + 2 * p2 * x * y};
}

double radial_fold_radius(const std::array<double, 3>& radial) {
  // Between its extrema the slope is monotonic, so each piece holds at most one root.
  double low = 0.0;
  for (const double s : extrema(radial)) {
    if (radial_slope(radial, s) <= 0.0) {
      return std::sqrt(bisect(low, s, [&](double at) { return radial_slope(radial, at); }));
    }
    low = s;
  }
  const double leading = radial[2] != 0.0 ? radial[2] : radial[1] != 0.0 ? radial[1] : radial[0];
  if (leading >= 0.0) {
    return kNever;
  }
  double high = std::max(1e-6, 2.0 * low);
  while (radial_slope(radial, high) > 0.0) {
    high *= 2.0;
  }
  return std::sqrt(bisect(low, high, [&](double at) { return radial_slope(radial, at); }));
}

double fold_radius(const Distortion& distortion) {
  const double limit = radial_fold_radius(distortion.radial);
  const double tau = std::hypot(distortion.tangential[0], distortion.tangential[1]);
  if (tau <= 0.0) {
    return limit;
  }
  // The tangential terms only bring the fold nearer. Steps that grow with the radius, because
  // nothing says how far away it is; a field of view of 89.9 degrees ends at radius 600.
  const double end = std::min(limit, 600.0);
  const auto determinant = [&](double r) { return worst_determinant(distortion, r); };
  double low = 0.0;
  while (low < end) {
    const double high = std::min(end, low + std::max(1e-4, 1e-3 * low));
    if (determinant(high) <= 0.0) {
      return bisect(low, high, determinant);
    }
    low = high;
  }
  return limit;
}

bool is_before_fold(const Distortion& distortion, const Vector2d& undistorted) {
  constexpr int kSteps = 256;
  for (int i = 1; i <= kSteps; ++i) {
    Matrix2d jacobian;
    distort(distortion, undistorted * (static_cast<double>(i) / kSteps), &jacobian);
    if (!(jacobian.determinant() > 0.0)) {
      return false;
    }
  }
  return true;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/surface/micro_relief.h"

#include <cmath>
#include <cstdint>

#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;

/// Finaliser of splitmix64 (G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number
/// generators", OOPSLA 2014): every bit of the result depends on every bit of x.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

/// Two independent Gaussian numbers of a crossing, by Box and Muller from 32 bits each.
Vector2d gaussian_at(std::int64_t column, std::int64_t row, int number) {
  const std::uint64_t seed = mixed(static_cast<std::uint64_t>(number));
  const std::uint64_t bits =
      mixed(mixed(seed ^ static_cast<std::uint64_t>(column)) ^ static_cast<std::uint64_t>(row));
  constexpr double kPerStep = 1.0 / 4294967296.0;
  const double radius =
      std::sqrt(-2.0 * std::log((static_cast<double>(bits >> 32U) + 0.5) * kPerStep));
  const double angle_rad = 2.0 * kPi * static_cast<double>(bits & 0xffffffffU) * kPerStep;
  return radius * Vector2d(std::cos(angle_rad), std::sin(angle_rad));
}

}  // namespace

/// Bilinear weights w lower the variance to the sum of their squares; dividing by its root gives it
/// back everywhere.
Vector2d relief_slope(double u_mm, double v_mm, int number) {
  const double u = u_mm / kReliefLattice_mm;
  const double v = v_mm / kReliefLattice_mm;
  const double column = std::floor(u);
  const double row = std::floor(v);
  const double across[2] = {1.0 - (u - column), u - column};
  const double along[2] = {1.0 - (v - row), v - row};
  Vector2d sum = Vector2d::Zero();
  double squares = 0.0;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const double weight = across[i] * along[j];
      sum += weight * gaussian_at(static_cast<std::int64_t>(column) + i,
                                  static_cast<std::int64_t>(row) + j,
                                  number);
      squares += weight * weight;
    }
  }
  return sum / std::sqrt(squares);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ishigami and Homma 1990 with a = 7, b = 0.1, whose Sobol indices are known: the second coordinate
// acts alone, the third by interaction with the first alone.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace glint::test {

/// The true indices of one coordinate.
struct TrueIndex {
  double first = 0.0;
  double total = 0.0;
};

/// @param unit  three coordinates in [0, 1]
inline double ishigami(std::span<const double> unit) {
  const auto angle = [&](std::size_t i) { return std::numbers::pi * (2.0 * unit[i] - 1.0); };
  return std::sin(angle(0)) * (1.0 + 0.1 * std::pow(angle(2), 4)) +
         7.0 * std::pow(std::sin(angle(1)), 2);
}

inline std::array<TrueIndex, 3> ishigami_indices() {
  const double pi4 = std::pow(std::numbers::pi, 4);
  const double first = 0.5 * std::pow(1.0 + 0.1 * pi4 / 5.0, 2);
  const double second = 7.0 * 7.0 / 8.0;
  const double together = 0.1 * 0.1 * pi4 * pi4 * 8.0 / 225.0;
  const double all = first + second + together;
  return {{{first / all, (first + together) / all},
           {second / all, second / all},
           {0.0, together / all}}};
}

}  // namespace glint::test

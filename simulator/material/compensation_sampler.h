// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "simulator/material/direction_table.h"

namespace glint {

/// Chooses directions about where a surface loses light: with a density near (1 - A) z, A the table
/// of its albedo, the same at all azimuths. Smooth metal loses light at grazing only, where a
/// cosine density would hardly ever look, and then with weights of thousands.
class CompensationSampler {
 public:
  /// @param width  about that of the surface's slopes; places the cells
  CompensationSampler(const DirectionTable& albedo, double width);

  /// From two numbers in [0, 1).
  LocalDirection sample(double u, double v) const;

  /// [1/sr]; 0 for z <= 0.
  double density(const LocalDirection& direction) const;

  // For kernels that repeat sample() and density().
  static constexpr int kCells = 32;

  double knee() const { return knee_; }

  double scale() const { return scale_; }

  const std::array<double, kCells>& mass() const { return mass_; }

 private:
  double z_of(double t) const;

  double knee_ = 1.0;   ///< cells are equal in log(1 + z / knee)
  double scale_ = 1.0;  ///< log(1 + 1 / knee)
  std::array<double, kCells> mass_{};
};

}  // namespace glint

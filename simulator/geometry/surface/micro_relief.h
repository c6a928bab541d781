// SPDX-License-Identifier: GPL-3.0-or-later
//
// The micro relief of a rough stain: slopes that look random and stay where they are, so that a
// picture is the same bytes however it is computed (docs/theory/parts.md).
#pragma once

#include <Eigen/Core>

namespace glint {

/// Slopes are drawn at the crossings of a lattice this wide and interpolated between.
inline constexpr double kReliefLattice_mm = 5e-3;

/// The slopes along u and v at a place: Gaussian with mean 0 and variance 1 at every place, both
/// independent of each other, continuous, uncorrelated from two lattice widths on.
/// @param number  of the stain; each has its own relief
Eigen::Vector2d relief_slope(double u_mm, double v_mm, int number);

}  // namespace glint

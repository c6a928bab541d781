// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the vertices of a cut cell contribute to its derivative, summed over the frames: an inner
// loop of stripe_gradient.cpp.
#pragma once

namespace glint::gradient_kernels {

/// Weighted sums over frames at a vertex: of the square wave less its mean, its first and second
/// integral, and their derivatives by the duty.
struct VertexSums {
  double wave = 0.0;
  double first = 0.0;
  double second = 0.0;
  double first_by_duty = 0.0;
  double second_by_duty = 0.0;
};

/// @param shift   of the stripes in each frame [periods]
/// @param weight  of each frame
/// @param sums    one for each phase
/// @return the sum of the weights
double weigh_vertices(const double* phases,
                      int vertices,
                      const double* shift,
                      const double* weight,
                      int frames,
                      double duty,
                      VertexSums* sums);

}  // namespace glint::gradient_kernels

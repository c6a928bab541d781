// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace glint {

/// Nodes in (0, 1) and weights (sum 1) of the Gauss-Legendre rule: exact for polynomials of degree
/// 2 count - 1.
struct Quadrature {
  std::vector<double> nodes;
  std::vector<double> weights;
};

/// @param count  >= 1
Quadrature gauss_legendre(int count);

}  // namespace glint

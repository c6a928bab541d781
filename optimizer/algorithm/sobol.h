// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sobol's sequence: points that fill the unit cube more evenly than random ones.
#pragma once

#include <cstdint>
#include <vector>

namespace glint {

/// As many as the table of Boost.Random holds.
inline constexpr int kMaxSobolDimension = 3667;

/// The sequence, in Gray-code order, under a digital shift drawn from the seed: still as even, but
/// different for each seed, and its first point is a random one instead of a corner. Direction
/// numbers: S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional
/// projections", SIAM J. Sci. Comput. 30, 2008 (new-joe-kuo-6.21201).
class Sobol {
 public:
  /// @throws ConfigError for more than kMaxSobolDimension dimensions
  Sobol(std::uint64_t seed, int num_dimensions);

  /// In [0, 1), any order, same index same point.
  std::vector<double> point(std::uint32_t index) const;

 private:
  std::vector<std::uint32_t> shifts_;
};

}  // namespace glint

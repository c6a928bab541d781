// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sobol's sequence: points that fill the unit cube more evenly than random ones.
//
// NLopt has a generator inside, but not in its public headers. Direction numbers: S. Joe and
// F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections", SIAM J. Sci.
// Comput. 30, 2008 (new-joe-kuo-6.21201), the first 40 dimensions. Dimensions beyond 40 are plain
// random numbers: at the few hundred points of a study their evenness could not show anyway.
#pragma once

#include <cstdint>
#include <vector>

namespace glint {

inline constexpr int kMaxSobolDimension = 40;

/// The sequence, in Gray-code order, under a digital shift drawn from the seed: still as even, but
/// different for each seed, and its first point is a random one instead of a corner.
class Sobol {
 public:
  Sobol(std::uint64_t seed, int num_dimensions);

  /// In [0, 1), any order, same index same point.
  std::vector<double> point(std::uint32_t index) const;

 private:
  std::uint64_t seed_;
  int num_dimensions_;
  std::vector<std::uint32_t> shifts_;
};

}  // namespace glint

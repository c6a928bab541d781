// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace glint {

/// What a random number is used for; streams of one seed are independent.
enum class Stream : std::uint32_t {
  kShotNoise = 1,
  kReadNoise,
  kSearch,
  kDefects,
  kTest,
  kLight,
  kAspectNoise,
  kResampling,
  kViewpoints,
  kBoardPoses,
  kRobotErrors
};

/// Philox 4x32-10: a keyed bijection from a 128-bit counter to 128 random bits.
///
/// Source: J. Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011; checked
/// against the known answers published with it (tests/core/rng_test.cpp).
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                    std::array<std::uint32_t, 2> key);

/// Counter-based random numbers: the sequence of (seed, stream, index) never depends on what was
/// drawn elsewhere, so pixels can be visited in any order and neighbouring candidates share them.
class Rng {
 public:
  Rng(std::uint64_t seed, Stream stream, std::uint64_t index);

  std::uint32_t next_u32();
  double uniform();  ///< in [0, 1), 53 bits

  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  double normal();  ///< mean 0, variance 1 (Box-Muller)

 private:
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> words_ = {};
  unsigned used_ = 4;
};

}  // namespace glint

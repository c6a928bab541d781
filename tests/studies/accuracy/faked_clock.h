// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint::test {

/// While one lives, every clock of the process that clock_gettime() reads, those of the CPU too,
/// jumps ahead by seconds to hours at each look, by made-up numbers.
class FakedClock {
 public:
  explicit FakedClock(unsigned seed);
  ~FakedClock();
  FakedClock(const FakedClock&) = delete;
  FakedClock& operator=(const FakedClock&) = delete;

  static int looks();  ///< at the faked clocks, of the last one
};

}  // namespace glint::test

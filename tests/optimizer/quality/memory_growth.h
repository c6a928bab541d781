// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much memory a piece of work takes at its most, beside what the process has before.
#pragma once

namespace glint::quality {

/// From where it is made on. What the process has freed before and keeps may be taken again unseen:
/// exact in a process that has done nothing else.
class MemoryGrowth {
 public:
  MemoryGrowth();

  /// Largest resident set since, less the one at the beginning.
  double mb() const;

 private:
  double start_mb_ = 0.0;
};

}  // namespace glint::quality

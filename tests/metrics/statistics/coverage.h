// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "core/rng.h"

namespace glint::testing {

/// Share of repeats in which a trial says that its interval held the truth. Every repeat draws from
/// a stream of its own.
template <class Trial>
double coverage(std::uint64_t seed, const Trial& holds, int repeats = 1000) {
  int held = 0;
  for (int i = 0; i < repeats; ++i) {
    Rng rng(seed, Stream::kTest, static_cast<std::uint64_t>(i));
    held += holds(rng) ? 1 : 0;
  }
  return static_cast<double>(held) / repeats;
}

}  // namespace glint::testing

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>

namespace glint {

/// How much of something a test takes: a number of the environment, by which CTest runs the same
/// program for longer, or the usual one.
inline int count_from(const char* variable, int usual) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? usual : std::atoi(text);
}

}  // namespace glint

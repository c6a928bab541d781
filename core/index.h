// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace glint {

/// Of a vertex, a triangle or a pixel, whose numbers are signed, in a container.
/// @param i  >= 0
constexpr std::size_t index(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

}  // namespace glint

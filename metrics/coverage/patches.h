// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace glint {

/// Points that hang together.
struct SurfacePatch {
  double weight = 0.0;
  std::vector<std::size_t> points;  ///< ascending
};

/// Of the points that are asked for the connected set of largest weight; of equal ones that with
/// the lowest point. Empty when none is asked for.
/// @param is_in    one a point: 1 for those that count
/// @param weights  one a point
/// @param links    pairs of neighbouring points
SurfacePatch largest_patch(std::span<const std::uint8_t> is_in,
                           std::span<const double> weights,
                           std::span<const std::array<std::int32_t, 2>> links);

}  // namespace glint

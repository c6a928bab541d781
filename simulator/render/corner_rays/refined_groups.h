// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulator/render/corner_rays/corner_rays.h"

namespace glint {

/// Numbers of cells a pixel's side may be cut into.
inline constexpr std::array<int, 4> kCellCounts = {2, 4, 8, 16};

inline std::size_t corners_of(int cells) {
  return static_cast<std::size_t>((cells + 1) * (cells + 1));
}

/// Refined pixels of one row that are cut into the same number of cells.
struct RowGroup {
  RefinedGroup group;                    ///< special is not set
  std::vector<std::uint8_t> is_special;  ///< per ray
};

/// The refined pixels of one row, by number of cells.
using RowGroups = std::array<RowGroup, kCellCounts.size()>;

/// Rays [first, first + count) of a cache and their flags, behind those of a row's group.
void append_rays(const RayCache& rays,
                 const std::uint8_t* is_special,
                 std::size_t first,
                 std::size_t count,
                 RowGroup& to);

/// The row's group of so many cells.
RowGroup& group_of(RowGroups& row, int cells);

/// Puts pixels in order: those that took several rounds come late.
void sort_by_pixel(RowGroup& row);

/// Gives back what growing has taken beyond the rays: up to as much again, for the rows of a whole
/// picture.
void shrink(RowGroup& row);

/// Joins the groups of all rows in their order and adds up their counts.
void join_groups(std::vector<RowGroups> rows, CornerRays& result);

}  // namespace glint

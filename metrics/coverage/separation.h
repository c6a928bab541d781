// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

namespace glint {

/// How many of some directions can be chosen so that any two of them are at least an angle apart:
/// the largest such choice, but no more than `enough`, at which the search ends. Two views from
/// nearly the same direction show a defect in the same way and are no second look at it.
/// Cost: some comparisons where directions are spread, of all pairs where they lie close together;
/// exponential in `enough` at worst.
/// @param directions      unit
/// @param separation_rad  in [0, pi]; 0: all count
/// @param nodes           if given, receives how many partial choices were looked at
int separated_count(std::span<const Eigen::Vector3d> directions,
                    double separation_rad,
                    int enough,
                    std::int64_t* nodes = nullptr);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "defects/part/defective_part.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"

namespace glint {

/// Share of a defect's area that is no steeper than its slope.
inline constexpr double kSlopeShare = 0.99;

/// How steep each defect is [rad], in the order of made.defects: the angle between its facets and
/// the flawless surface, below which kSlopeShare of its area lies; at most pi / 2, which is a wall.
/// The surface is the exact one that the defect lies in, or the part's smooth surface nearest to
/// each facet. A defect realised by its normals has the steepest angle of its height; stains,
/// defects that were given up, and those that later ones have swallowed have 0.
/// Cost: without exact surfaces a search for the nearest point for each facet of a defect.
/// @param mesh   the finished one, to which made.labels belong
/// @param clean  the flawless part, with its bvh
std::vector<double> defect_slopes_rad(const DefectivePart& made,
                                      const TriangleMesh& mesh,
                                      const Part& clean,
                                      const Bvh& bvh);

}  // namespace glint

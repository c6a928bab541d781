// SPDX-License-Identifier: GPL-3.0-or-later
//
// Distances as anybody would write them down: all triangles against all, each pair by its corners
// and edges. Slow, and independent of what plans.
#pragma once

#include <array>
#include <string>

#include "hardware/planning/clearance.h"

namespace glint {

using Corners = std::array<Eigen::Vector3d, 3>;

double segment_distance(const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c,
                        const Eigen::Vector3d& d);

double triangle_distance(const Corners& first, const Corners& second);

/// Smallest distance of what moves to table and standing bodies at joints, mm; and to the box of
/// the cell, 0 where that is left.
double plain_margin_mm(const PlanningCell& cell,
                       const std::vector<SolidBody>& bodies,
                       const JointVector& joints_rad,
                       std::string* nearest = nullptr);

/// Smallest distance of the arm and what it carries to itself, mm; negative: they touch. Of pairs
/// whose housings do not always overlap: base to elbow against wrist 3 and what follows it, forearm
/// against tool and what is carried, wrist 1 and 2 against what is carried.
double plain_self_mm(const PlanningCell& cell,
                     const std::vector<SolidBody>& bodies,
                     const JointVector& joints_rad,
                     std::string* nearest = nullptr);

}  // namespace glint

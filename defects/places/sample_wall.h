// SPDX-License-Identifier: GPL-3.0-or-later
//
// How thick the part is below a defect.
#pragma once

#include <Eigen/Core>

#include "defects/definition/defect.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"

namespace glint {

/// The way along -normal from a point of the surface to where it leaves the material [mm];
/// infinite when it never does (an open mesh).
double wall_below(const Part& part,
                  const Bvh& bvh,
                  const Eigen::Vector3d& point_mm,
                  const Eigen::Vector3d& normal);

/// The thinnest wall below a defect: at its place, and at points along a line.
double wall_below(const Part& part, const Bvh& bvh, const Defect& defect);

}  // namespace glint

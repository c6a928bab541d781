// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of the arm in its cell: the arm grey, what it carries blue, what stands in the cell
// orange.
#pragma once

#include <string>
#include <vector>

#include "core/image/image_io.h"
#include "core/thread_pool.h"
#include "hardware/planning/planning_cell.h"

namespace glint {

/// A body as triangles: a capsule with its round ends, a mesh as it is, without its thickness.
TriangleMesh visible_mesh(const SolidBody& body);

/// Arm and cell from the side, joints as given. @param side_px  of the square picture, > 0
ImageRgb draw_cell(const PlanningCell& cell,
                   const JointVector& joints_rad,
                   int side_px,
                   ThreadPool& pool);

/// Pictures of one size in rows of so many, in their order.
ImageRgb picture_sheet(const std::vector<ImageRgb>& pictures, int columns);

}  // namespace glint

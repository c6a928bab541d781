// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "defects/tools/line_frames.h"
#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// A mesh drawn along x (z = 0 the surface) bent along the frames, cut into slabs first where they
/// are not straight. @param step_mm thickness of the slabs, > 0
TriangleMesh bent_along(const TriangleMesh& mesh,
                        const LineFrames& frames,
                        double step_mm,
                        double window_mm);

/// The same shape with every triangle cut into four at the middles of its edges.
TriangleMesh quartered(const TriangleMesh& mesh);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// Why the mesh cannot be a tool, as a sentence; empty when it is closed, turned outwards, has no
/// face without area and does not cross itself.
std::string tool_fault(const TriangleMesh& tool);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

struct PatchTool;

/// Which triangles a tool meets or holds.
class ToolReach {
 public:
  /// @param tool  closed, without fault; must outlive this
  explicit ToolReach(const TriangleMesh& tool);
  ~ToolReach();
  ToolReach(const ToolReach&) = delete;
  ToolReach& operator=(const ToolReach&) = delete;

  /// True when the triangle meets the tool's surface, by boxes about faces, or lies inside it.
  bool reaches(const std::array<Eigen::Vector3d, 3>& corners_mm) const;

 private:
  std::unique_ptr<const PatchTool> tool_;
};

}  // namespace glint

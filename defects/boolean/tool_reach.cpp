// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/boolean/tool_reach.h"

#include "defects/boolean/patch_tool.h"

namespace glint {

ToolReach::ToolReach(const TriangleMesh& tool) : tool_(std::make_unique<const PatchTool>(tool)) {}

ToolReach::~ToolReach() = default;

bool ToolReach::reaches(const std::array<Eigen::Vector3d, 3>& corners_mm) const {
  if (!tool_->box.may_intersect(corners_mm)) {
    return false;
  }
  const FloatBox query = box_of(corners_mm[0], corners_mm[1], corners_mm[2]);
  bool is_met = false;
  tool_->tree.visit_if([&](const FloatBox& box) { return !is_met && box.overlaps(query); },
                       [&](std::int32_t) { is_met = true; });
  return is_met || tool_->contains(corners_mm[0]);
}

}  // namespace glint

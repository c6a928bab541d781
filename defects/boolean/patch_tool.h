// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "defects/boolean/box_tree.h"
#include "defects/boolean/patch_crossings.h"
#include "defects/boolean/patch_edges.h"

namespace glint {

/// A box along the tool's own axes, a little larger than the tool.
class OrientedBox {
 public:
  OrientedBox() = default;
  explicit OrientedBox(const std::vector<Eigen::Vector3d>& points_mm);

  const FloatBox& bounds() const { return bounds_; }

  /// False only when box and oriented box certainly have no point in common.
  bool may_intersect(const FloatBox& box) const;
  /// False only when triangle and oriented box certainly have no point in common.
  bool may_intersect(const Corners& corners) const;
  /// True only when the point is certainly outside.
  bool is_outside(const Eigen::Vector3d& point) const;

 private:
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  ///< rows
  Eigen::Matrix3d abs_axes_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d centre_mm_ = Eigen::Vector3d::Zero();  ///< along the axes
  Eigen::Vector3d half_size_mm_ = Eigen::Vector3d::Zero();
  FloatBox bounds_;
};

/// A tool with all that is needed to look things up in it.
struct PatchTool {
  explicit PatchTool(const TriangleMesh& mesh);

  /// Is a point, not on the surface, inside?
  bool contains(const Eigen::Vector3d& point) const;

  std::span<const Triangle> triangles;
  std::span<const Eigen::Vector3d> vertices_mm;
  EdgeMatches edges;
  std::vector<TestFace> faces;
  BoxTree tree;
  OrientedBox box;
};

}  // namespace glint

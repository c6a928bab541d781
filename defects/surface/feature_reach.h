// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::defects::surface: which faces the height features of a displacement reach,
// and how fine these must be.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "simulator/geometry/surface/surface_detail.h"

namespace glint {

/// A triangle of the surface with its shading normals.
struct SurfaceTriangle {
  std::array<Eigen::Vector3d, 3> points_mm;
  std::array<Eigen::Vector3d, 3> normals;
};

/// The triangle of a mesh, which must have shading normals.
SurfaceTriangle surface_triangle(const TriangleMesh& mesh, std::int32_t face);

/// Features by place: boxes in a uniform grid.
class FeatureReach {
 public:
  explicit FeatureReach(std::span<const HeightFeature> features);

  /// The longest edge [mm] this triangle may have; infinite where no feature reaches it from the
  /// side its normals point to.
  double allowed_edge_mm(const SurfaceTriangle& triangle, double edges_per_sigma) const;

 private:
  std::array<int, 3> cell_at(const Eigen::Vector3d& p_mm) const;
  template <class Visit>
  void visit_cells(const BoundingBox& box, const Visit& visit) const;

  static constexpr int kCells = 32;  ///< along each axis

  std::span<const HeightFeature> features_;
  std::vector<BoundingBox> boxes_;
  BoundingBox box_;
  Eigen::Vector3d cells_per_mm_ = Eigen::Vector3d::Zero();
  std::vector<std::vector<std::int32_t>> cells_;
};

}  // namespace glint

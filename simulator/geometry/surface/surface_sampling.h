// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points on a part's surface: random ones in proportion to area, and the smooth surface (exact
// patch or shading normals) at a point of a triangle. Scene frame. docs/theory/imprint.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/rng.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"
#include "simulator/geometry/surface/surface_detail.h"

namespace glint {

/// Neighbouring faces that meet at more than this are not one surface for a defect.
inline constexpr double kSharpBend_rad = 30.0 * kRadPerDeg;

/// A point of the smooth surface.
struct SurfacePoint {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, outwards
  std::int32_t triangle = -1;
};

/// Moves a point along the surface's normals onto an exact patch, to about 1e-12 mm. Empty when
/// that does not converge or the point is further away than max_move_mm. triangle stays -1.
std::optional<SurfacePoint> onto_patch(const ExactPatch& patch,
                                       const Eigen::Vector3d& p_mm,
                                       double max_move_mm);

/// The smooth surface that a triangle stands for, at a point on or near that triangle: point and
/// normal of its exact patch; without one the point itself and the interpolated shading normal.
SurfacePoint smooth_point(const Part& part, std::int32_t triangle, const Eigen::Vector3d& p_mm);

/// The normal of a defect of that radius: of the exact patch, else the mean of the shading normals
/// over the disc of that radius, leaving out what lies around sharp bends.
Eigen::Vector3d footprint_normal(const Part& part,
                                 const Bvh& bvh,
                                 const SurfacePoint& at,
                                 double radius_mm);

/// Axes at a point: u as close to the part's x axis as can be (its y axis where the normal is
/// along x), turned by angle_rad about the normal.
SurfacePlace oriented_place(const Part& part,
                            const Eigen::Vector3d& centre_mm,
                            const Eigen::Vector3d& normal,
                            double angle_rad);

/// A piece of a triangle of the mesh.
struct SurfacePiece {
  std::int32_t triangle = -1;
  std::array<Eigen::Vector3d, 3> corners_mm;
};

/// Draws points that are uniform over the area of some triangles. 8 to 12 bytes a triangle.
class AreaSampler {
 public:
  struct Sample {
    std::int32_t triangle = -1;
    Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  };

  AreaSampler() = default;
  /// Every triangle of a mesh.
  explicit AreaSampler(const TriangleMesh& mesh);
  /// Some of its triangles.
  AreaSampler(const TriangleMesh& mesh, std::vector<std::int32_t> triangles);
  explicit AreaSampler(std::vector<SurfacePiece> pieces);

  double area_mm2() const { return sums_mm2_.empty() ? 0.0 : sums_mm2_.back(); }

  /// Takes three numbers from the generator. There must be area.
  Sample draw(const TriangleMesh& mesh, Rng& rng) const;

 private:
  std::vector<double> sums_mm2_;         ///< area of this and all before
  std::vector<std::int32_t> triangles_;  ///< empty: every one of the mesh, or pieces
  std::vector<SurfacePiece> pieces_;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Height on the surface: dents, bumps and scratches too flat for the mesh. They tilt the normal,
// and move the position where wanted. Stains on the same coordinates reflect less and are rough.
// geometry owns the type, defects fill it, render reads it.
// Everything is in the scene frame, like Part::mesh.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"

namespace glint {

/// One height feature in a local frame (u, v, normal) on the surface, orthonormal.
///
/// kGaussian: h = height exp(-r^2 / (2 sigma^2)). Its diameter is 4 sigma, its steepest slope
/// height / (sigma sqrt(e)) at r = sigma.
/// kScratch: the same with r = the distance to a line along u, so that it has a Gaussian
/// cross-section of full width 4 sigma = width_mm and rounded ends; length_mm counts from end to
/// end. A scratch shorter than wide is round.
///
/// A stain (height 0, or together with a height) covers one radius = 2 sigma, with an edge of
/// kStainRim on both sides; see docs/theory/parts.md.
struct HeightFeature {
  enum class Kind { kGaussian, kScratch };

  Kind kind = Kind::kGaussian;
  std::string label = {};
  int id = 0;  ///< >= 0
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d u_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d v_axis = Eigen::Vector3d::UnitY();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double height_mm = 0.0;       ///< positive outwards (bump), negative inwards (dent)
  double sigma_mm = 0.0;        ///< Gaussian, > 0
  double length_mm = 0.0;       ///< scratch, > 0
  double width_mm = 0.0;        ///< scratch, > 0
  bool moves_position = false;  ///< also shifts the surface point, not only its normal
  double reflectance = 1.0;     ///< stain: against the clean surface, 0 to 1
  double roughness_rad = 0.0;   ///< stain: rms slope of its micro relief along any line, >= 0

  double cross_sigma_mm() const { return kind == Kind::kGaussian ? sigma_mm : width_mm / 4.0; }

  /// Half the length of the line the distance is measured to; 0 for a Gaussian.
  double half_line_mm() const;
  /// height / (sigma sqrt(e)), always >= 0.
  double max_slope_rad() const;

  bool is_stain() const { return reflectance != 1.0 || roughness_rad > 0.0; }
};

/// The height features of a part, found by place through a uniform grid.
class SurfaceDetail {
 public:
  struct Sample {
    double height_mm = 0.0;        ///< sum over all features
    double moved_height_mm = 0.0;  ///< sum over those that move the position
    double reflectance = 1.0;      ///< product over all stains
    /// of height_mm and of micro relief; tangential to the feature's plane, hence nearly to the
    /// surface
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    int feature = -1;  ///< id of the nearest feature (in radii) that reaches here, -1: none
    double normalised_distance = 0.0;  ///< to it, in feature radii (2 sigma): <= 1 is inside
  };

  /// A feature counts up to this many radii (2.5 radii = 5 sigma, 4e-6 of its height).
  static constexpr double kReachRadii = 2.5;
  /// A stain is whole up to 1 - kStainRim radii and ends at 1 + kStainRim.
  static constexpr double kStainRim = 0.1;

  /// Whether the micro relief of stains counts. Derivatives leave it out: over a step of theirs it
  /// says nothing about the mean over a pixel.
  enum class Relief { kWith, kWithout };

  SurfaceDetail() = default;
  /// @throws ConfigError naming the feature's label: size not positive or not finite.
  explicit SurfaceDetail(std::vector<HeightFeature> features);

  const std::vector<HeightFeature>& features() const { return features_; }

  bool empty() const { return features_.empty(); }

  /// Heights at a point of the smooth surface; a feature acts only where the surface's normal
  /// points to its own side, so that a dent does not come out at the back of a sheet.
  Sample sample(const Eigen::Vector3d& p_mm,
                const Eigen::Vector3d& normal,
                Relief relief = Relief::kWith) const;

 private:
  void build_grid();
  int cell_of(const Eigen::Vector3d& p_mm) const;
  std::array<int, 3> coordinates_of(const Eigen::Vector3d& p_mm) const;
  std::vector<int> cells_in(const BoundingBox& box) const;

  std::vector<HeightFeature> features_;
  BoundingBox box_;
  Eigen::Vector3d cells_per_mm_ = Eigen::Vector3d::Zero();
  std::array<int, 3> num_cells_ = {0, 0, 0};
  std::vector<std::int32_t> cell_begin_;  ///< per cell, into cell_features_; one more at the end
  std::vector<std::int32_t> cell_features_;
};

/// The unit normal of the smooth surface tilted by a height gradient. The tilt is reduced where the
/// mirrored ray would otherwise dip below the smooth surface.
/// @param normal         unit, of the smooth surface
/// @param gradient       of the height; its tangential part counts
/// @param ray_direction  unit, of the ray that arrives (ray_direction . normal < 0)
Eigen::Vector3d detailed_normal(const Eigen::Vector3d& normal,
                                const Eigen::Vector3d& gradient,
                                const Eigen::Vector3d& ray_direction);

/// Where a feature given by x and y in the part frame sits: centre, normal, and tangent axes with u
/// as close to the part's x axis as can be, turned by angle_rad about the normal.
struct SurfacePlace {
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d u_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d v_axis = Eigen::Vector3d::UnitY();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

/// Looks down the part's -z axis from above; empty when that line misses the part.
std::optional<SurfacePlace> place_on_surface(
    const Part& part, const Bvh& bvh, double x_mm, double y_mm, double angle_rad = 0.0);

}  // namespace glint

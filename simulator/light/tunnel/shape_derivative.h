// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the hits of rays move when a key of the tunnel's cross-section, or a ray, changes. A wall
// that moves by nu along its outward normal n per unit of a key moves the hit of a ray (o, d) by
//
//     dt = nu / (n . d)   along the ray (implicit differentiation of F(o + t d; key) = 0),
//
// and a ray that changes by (do, dd) adds do + t dd, less its part through the wall. The derivative
// of a number by all keys is taken in reverse mode: its derivatives by the hits are collected once,
// at the places of the wall; each key then costs a sum over these places.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "simulator/light/tunnel/shape_derivative_kernels.h"
#include "simulator/light/tunnel/tunnel.h"

namespace glint {

/// Where rays meet the wall.
struct HitBlock {
  const float* x_mm = nullptr;
  const float* y_mm = nullptr;
  const float* margin_mm = nullptr;
};

/// Derivatives of rays by one number, as the rays they belong to.
struct RayMotion {
  const float* origin_x = nullptr;
  const float* origin_y = nullptr;
  const float* origin_z = nullptr;
  const float* direction_x = nullptr;
  const float* direction_y = nullptr;
  const float* direction_z = nullptr;
};

class ShapeDerivative {
 public:
  explicit ShapeDerivative(const Tunnel& tunnel);

  /// Adds rays to the sums that derivative_by() needs.
  void collect(const RayBlock& rays, const HitBlock& hits, const HitGradient& derivatives);

  /// The collected number's derivative by a key of the cross-section in its internal unit
  /// ("base_mm", "radius_mm", "control_mm.2", "opening_deg" per radian, ...); a key of another
  /// shape changes nothing. Empty for a key that is none of the cross-section's.
  std::optional<double> derivative_by(std::string_view key) const;

  /// The derivative of a number when the rays move. Nothing is collected.
  double derivative_by_rays(const RayBlock& rays,
                            const RayMotion& motion,
                            const HitBlock& hits,
                            const HitGradient& derivatives) const;

 private:
  /// A place of the wall, between two nodes.
  struct Place {
    std::size_t node = 0;
    double part = 0.0;
    Eigen::Vector2d normal = Eigen::Vector2d::UnitY();
    Eigen::Vector2d margin_gradient = Eigen::Vector2d::UnitY();  ///< by (y, z)
    bool is_near_top = false;                                    ///< flat: the margin is to the top
  };

  void collect_curve(const RayBlock& rays, const HitBlock& hits, const HitGradient& derivatives);
  void collect_flat(const RayBlock& rays, const HitBlock& hits, const HitGradient& derivatives);
  void build_superellipse();
  void build_free();
  void build_flat();
  Place place_of(double y_mm, double margin_mm, double z_mm) const;
  double height_of(double y_mm, double margin_mm, const RayBlock& rays, int i) const;
  std::vector<double> speeds_of(std::string_view key) const;
  double superellipse_speed(std::string_view key, std::size_t node) const;
  double derivative_of_flat(std::string_view key) const;

  TunnelSettings settings_;
  bool is_flat_ = false;
  // Curves, at the nodes of WallNormals:
  std::vector<Eigen::Vector2d> normals_;
  std::vector<float> normals_y_, normals_z_;  ///< the same
  std::vector<std::size_t> segments_;         ///< free: the piece that a node lies on ...
  std::vector<double> places_;                ///< ... and where on it
  // Flat: the right wall; the left one mirrors it.
  FlatWall wall_;
  bool touch_at_top_ = false;
  // Collected:
  std::vector<double> by_node_;  ///< derivative by a shift of the wall along its normal
  double by_shift_ = 0.0;        ///< flat: sums of the derivative by the wall's shift ...
  double by_turn_ = 0.0;         ///< ... and times the distance from its foot
  double by_margin_ = 0.0;       ///< of hits whose margin is to the foot
  double by_top_ = 0.0;          ///< of hits whose margin is to the top
};

}  // namespace glint

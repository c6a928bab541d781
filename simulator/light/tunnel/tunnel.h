// SPDX-License-Identifier: GPL-3.0-or-later
//
// A fringe tunnel: a luminous wall extruded along x, with bright and dark stripes, moved along x
// step by step. The cross-section lies in the y-z plane above the line (0, base).
//
//   flat          two panels at y = +-distance, leaning inwards by half the opening angle
//   semicylinder  radius
//   ellipse       half axes half_width (y) and height (z)
//   superellipse  |y / half_width|^exponent + |(z - base) / height|^exponent = 1
//   free          clamped uniform cubic B-spline whose control points stand at equal angles from
//   the
//                 rim (control_mm[0]) to the top (the last), mirrored in the x-z plane
//
// A Lambertian wall has constant radiance: 1 on bright stripes, times the unevenness of the LEDs.
// Dark stripes of reflectance rho return some of it, more where they see more of the wall
// (dark_radiance.h). Radiance is linear, 1 = full scale of the sensor at exposure and gain 1.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "simulator/light/tunnel/dark_radiance.h"
#include "simulator/light/tunnel/spline_kernels.h"
#include "simulator/light/tunnel/tunnel_kernels.h"
#include "simulator/light/tunnel/tunnel_settings.h"

namespace glint {

/// At most `max_count` rays from `begin` on.
RayBlock part_of(const RayBlock& rays, int begin, int max_count);

/// Where a ray meets the luminous wall.
struct WallHit {
  double t_mm = 0.0;
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, towards the inside
  double arc_mm = 0.0;  ///< along the cross-section from its middle, positive for y > 0
};

/// A tunnel that can be hit. Immutable and safe to share between threads.
class Tunnel {
 public:
  /// @throws ConfigError when the cross-section cannot be built (control points not > 0, ...).
  explicit Tunnel(const TunnelSettings& settings);

  const TunnelSettings& settings() const { return settings_; }

  /// The nearest hit with the wall, the slot left out, ends not considered (they move with the
  /// scan). Exact to 1e-9 mm; the reference for hit_block(). Rays start inside the tunnel.
  std::optional<WallHit> hit(const Ray& ray) const;

  /// Hits of many rays in float: where each meets the wall and how bright the wall is there before
  /// stripes. Output arrays are as long as the block.
  /// @param x_mm       along the tunnel
  /// @param pattern_mm coordinate along which the stripes alternate (= x for straight stripes)
  /// @param gain       0 where no wall is met
  void hit_block(const RayBlock& rays, float* x_mm, float* pattern_mm, float* gain) const;

  /// The same hits for rays whose neighbours matter: coordinates that run on smoothly across the
  /// slot and beyond the wall's ends, so that a boundary of the light can be found between rays.
  /// A ray meets the light where margin >= 0, |y| >= slot / 2 and |x - shift| < length / 2.
  /// @param x_mm       along the tunnel
  /// @param y_mm       across it
  /// @param margin_mm  how far inside the lower rim of the wall (flat: its nearest end);
  ///                   kNoHitMargin_mm where not even the extended wall is met
  void intersect_block(const RayBlock& rays, float* x_mm, float* y_mm, float* margin_mm) const;

  /// What else oblique stripes and the cosine law need at the hits of intersect_block().
  /// @param pattern_mm coordinate along which the stripes alternate
  /// @param cosine     between ray and wall; 1 without cosine law
  void hit_details(const RayBlock& rays,
                   const float* x_mm,
                   const float* y_mm,
                   const float* margin_mm,
                   float* pattern_mm,
                   float* cosine) const;

  /// How far rays are from the wall, and where along it they meet it.
  /// @param gain  1, or 0 where no wall is met
  void cross_wall(const RayBlock& rays, float* t_mm, float* x_mm, float* gain) const;

  /// From a point (y, z) of the wall to where its cross-section ends, at a rim or the slot.
  double to_edge_mm(const Eigen::Vector2d& point) const;

  /// The stripes when the tunnel has moved by shift_mm along x. Where the radiance of dark ones
  /// depends on the place, the pattern's is 0: the place's has to be mixed in.
  StripePattern pattern(double shift_mm) const;

  /// True when the point (y, z) lies inside the cross-section.
  bool contains(double y_mm, double z_mm) const;

  /// The luminous wall as polylines in the y-z plane, the slot left out.
  std::vector<std::vector<Eigen::Vector2d>> outline(double max_step_mm) const;

  /// Radiance of dark stripes along the cross-section.
  const DarkRadiance& dark() const { return dark_; }

  /// That of a point (y, z) of the wall.
  double dark_at(const Eigen::Vector2d& point) const {
    return dark_.at(point.x(), to_rim_mm(point));
  }

  double half_width_mm() const;  ///< largest |y| of the wall
  double top_mm() const;         ///< largest z of the wall

 private:
  /// @param is_whole  also the continuation of the wall below its rim
  void hit_profile(const RayBlock& rays, bool is_whole, float* t_mm) const;
  std::optional<double> hit_profile(const Eigen::Vector2d& origin,
                                    const Eigen::Vector2d& direction) const;
  /// The profile's piece [i, i + 1] that a point of the wall belongs to.
  std::size_t profile_piece(const Eigen::Vector2d& point) const;
  WallHit wall_hit(const Ray& ray, double t_mm) const;
  bool panels_touch() const;
  double distance_to(const Ray& ray, float y_mm, float margin_mm) const;
  void set_details(const Ray& ray, double t_mm, float x_mm, float& pattern_mm, float& cosine) const;
  bool in_slot(const Eigen::Vector2d& point) const;
  double to_rim_mm(const Eigen::Vector2d& point) const;
  void build_profile();
  std::vector<Eigen::Vector2d> half_wall() const;

  TunnelSettings settings_;
  std::vector<FlatWall> walls_;                   ///< flat
  std::vector<SplineSegment> segments_;           ///< free
  std::vector<SplineSegment> extended_segments_;  ///< free, running on straight below the rim
  std::vector<Eigen::Vector2d> profile_yz_mm_;    ///< dense, from y < 0 to y > 0
  std::vector<double> arc_mm_;                    ///< per profile point, 0 in the middle
  double slot_floor_mm_ = 0.0;                    ///< the slot is cut above this height
  DarkRadiance dark_;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rays and where they meet a tunnel's wall in double, without the fast forms of the program.
#pragma once

#include <optional>
#include <vector>

#include "simulator/light/tunnel/spline_kernels.h"
#include "studies/imaging/traced_scene.h"

namespace glint {

/// Escaped rays, in the order of a RayCache.
struct ExactRays {
  std::vector<Eigen::Vector3d> origin_mm, direction;
};

/// Rays of the corners and of each refined group.
struct ExactPicture {
  ExactRays corners;
  std::vector<ExactRays> refined;
};

/// The rays that the scene was traced with.
ExactPicture picture_of(const CornerRays& rays);

/// The rays through the same places of the image by another camera. Rays that do not escape after
/// one reflection stay as they were.
ExactPicture picture_from(const TracedScene& traced,
                          const SceneSettings& scene,
                          const RigidTransform& camera_from_world);

/// Where a ray meets the wall, in the coordinates of Tunnel::intersect_block().
struct ExactPlace {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double margin_mm = -1e30;
};

class ExactWall {
 public:
  /// @param settings  must outlive this object
  explicit ExactWall(const TunnelSettings& settings);

  ExactPlace intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

 private:
  std::optional<double> distance(const Eigen::Vector2d& from, const Eigen::Vector2d& along) const;
  std::optional<double> to_panels(const Eigen::Vector2d& from, const Eigen::Vector2d& along) const;
  std::optional<double> to_curve(const Eigen::Vector2d& axes,
                                 double exponent,
                                 const Eigen::Vector2d& from,
                                 const Eigen::Vector2d& along) const;
  double flat_margin(const Eigen::Vector2d& point) const;

  const TunnelSettings& s_;
  std::vector<FlatWall> walls_;
  std::vector<SplineSegment> segments_;
};

}  // namespace glint

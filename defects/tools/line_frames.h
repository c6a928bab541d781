// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "simulator/geometry/surface/surface_detail.h"
#include "simulator/geometry/surface/surface_path.h"

namespace glint {

/// A place on a curve with an orthonormal right-handed frame (tangent, across, normal).
struct LineFrame {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();
  Eigen::Vector3d across = Eigen::Vector3d::UnitY();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();

  Eigen::Vector3d at(double across_mm, double height_mm) const {
    return point_mm + across_mm * across + height_mm * normal;
  }
};

/// Frames along a path on the surface, which tools are swept along or bent with. Between its points
/// it is interpolated, beyond its ends it goes straight on. Before it has turned by 157 degrees on
/// one side, where the ends of a tool could meet behind the part, it is cut.
class LineFrames {
 public:
  /// @param path   fewer than two points: straight along the place's u axis
  LineFrames(std::span<const SurfacePathPoint> path, const SurfacePlace& place);

  /// @param window_mm  the frame is averaged over this much to both sides; the point is not
  LineFrame at(double arc_mm, double window_mm) const;

  bool is_straight() const { return largest_bend_per_mm_ < 1e-9; }

  /// Largest turn of the frame per length of the path [1/mm].
  double largest_bend_per_mm() const { return largest_bend_per_mm_; }

  /// Half the longest line that fits; infinite unless the path had to be cut.
  double half_length_mm() const { return half_length_mm_; }

 private:
  void cut_long_turns();
  SurfacePathPoint interpolated(double arc_mm) const;

  std::vector<SurfacePathPoint> path_;
  SurfacePlace place_;
  double largest_bend_per_mm_ = 0.0;
  double half_length_mm_ = std::numeric_limits<double>::infinity();
};

}  // namespace glint

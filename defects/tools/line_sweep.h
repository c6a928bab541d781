// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"
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

/// A procedural scratch or gouge. With depth share s(x) = 1 - |2 x / length|^taper along and
/// t = |2 y / width| across, its lower side lies at depth_mm (t^section - s): both depth and width
/// go to 0 at the ends.
struct LineTool {
  double length_mm = 3.0;  ///< from end to end of the opening in a flat surface
  double width_mm = 0.3;   ///< of the opening, in the middle
  double depth_mm = 0.05;  ///< of the lowest point, exactly, after the noise
  double section = 1.0;    ///< 1: a V; 2: a parabola
  double taper = 6.0;      ///< 2: deepest in the middle only; larger: even, with short ends
  double roughness = 0.0;  ///< rms of the noise, share of the depth and of the half width
  double lean = 0.0;       ///< shift across per height: tangent of the tilt
  int level = 3;           ///< about 20 * 4^level triangles, more where the path bends a lot
  std::uint64_t seed = 0;
};

/// Closed, outwards, in the frame of the path. Sections stay in planes that follow one another
/// without crossing inside the tool: where the path bends too much for that, the frame is averaged
/// over a longer stretch and the part of the tool above the surface made lower.
TriangleMesh line_tool(const LineTool& shape, const LineFrames& frames);

/// A mesh drawn along x (z = 0 the surface) bent along the frames, cut into slabs first where they
/// are not straight. @param step_mm thickness of the slabs, > 0
TriangleMesh bent_along(const TriangleMesh& mesh,
                        const LineFrames& frames,
                        double step_mm,
                        double window_mm);

}  // namespace glint

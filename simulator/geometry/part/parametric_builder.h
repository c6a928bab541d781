// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::geometry::part: how parametric parts are put together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/part/exact_surface.h"
#include "simulator/geometry/part/part.h"

namespace glint::parametric {

/// Collects vertices, triangles and exact patches; each corner gets the exact normal there.
class Builder {
 public:
  std::int32_t add_vertex(const Eigen::Vector3d& p_mm);
  std::int32_t add_patch(const ExactPatch& patch);
  /// The plane through a point with an outward unit normal.
  std::int32_t add_plane(const Eigen::Vector3d& point_mm, const Eigen::Vector3d& normal);
  void add_triangle(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t patch);
  /// Corners counter-clockwise seen from outside.
  void add_quad(const std::array<std::int32_t, 4>& corners, std::int32_t patch);

  const Eigen::Vector3d& vertex(std::int32_t i) const {
    return mesh_.vertices_mm[static_cast<std::size_t>(i)];
  }

  /// Moves mesh and patches out.
  void finish(Part& part);

 private:
  std::int32_t normal_at(std::int32_t vertex, std::int32_t patch);

  TriangleMesh mesh_;
  std::vector<ExactPatch> patches_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> normal_of_;  ///< (vertex, patch)
};

/// A closed loop of vertices with an increasing angle each, spanning less than a full turn.
struct Loop {
  std::vector<std::int32_t> vertices;
  std::vector<double> angles_rad;

  std::size_t size() const { return vertices.size(); }
};

/// Fills the band between two loops; lower runs to the right, seen from outside with upper on top.
void stitch(Builder& builder, const Loop& lower, const Loop& upper, std::int32_t patch);

/// Joins every segment of a loop with one vertex; the loop runs counter-clockwise from outside.
void fan(Builder& builder, const Loop& loop, std::int32_t centre, std::int32_t patch);

/// The loop backwards, for faces seen from the other side.
Loop reversed(const Loop& loop);

/// The segments a circle's arc needs to stay within chord_mm; >= 1.
int arc_segments(double radius_mm, double angle_rad, double chord_mm);

/// The pieces of at most step_mm that a length needs; >= 1.
int pieces(double length_mm, double step_mm);

/// The pieces a length needs so that cells along it are at most 16 times longer than step_mm.
int slices(double length_mm, double step_mm);

/// A closed profile around the x axis, pushed along x: outline and the patch of each segment.
struct Profile {
  std::vector<Eigen::Vector2d> points_mm;  ///< (y, z), counter-clockwise seen from +x
  std::vector<std::int32_t> patches;       ///< of the segment that starts at the point
};

/// Side faces of a profile between -length / 2 and +length / 2; returns the two end loops (at -x,
/// at +x) without angles. @param is_hole turns the faces around
std::pair<Loop, Loop> extrude(
    Builder& builder, const Profile& profile, double length_mm, int num_slices, bool is_hole);

}  // namespace glint::parametric

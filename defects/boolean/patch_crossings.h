// SPDX-License-Identifier: GPL-3.0-or-later
//
// Do faces of a triangle mesh cross each other? Doubles decide where rounding cannot matter, exact
// predicates where it can.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "defects/boolean/box_tree.h"
#include "defects/boolean/corefine.h"
#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// A face with what the tests need of it. Equal indices mean the same point.
struct TestFace {
  TestFace() = default;
  TestFace(const Triangle& indices, const Corners& points);

  FloatBox box() const { return box_of(corners[0], corners[1], corners[2]); }

  Triangle ids = {};
  Corners corners;
  Eigen::Vector3d normal;     ///< cross product of two edges
  double normal_scale = 0.0;  ///< product of their lengths: normal is this exact
};

/// Exactly: on which side of a face, or of three points, does a point lie? See exact_orientation().
int orientation(const TestFace& face, const Eigen::Vector3d& point);
int orientation(const Eigen::Vector3d& a,
                const Eigen::Vector3d& b,
                const Eigen::Vector3d& c,
                const Eigen::Vector3d& d);

/// Exactly: a face without area.
bool is_degenerate(const TestFace& face);

/// Exactly, for faces with area: have they more in common than the corners they share?
bool faces_cross(const TestFace& a, const TestFace& b);

/// False only when the faces certainly have no point in common; quick.
bool may_intersect(const TestFace& a, const TestFace& b);

/// Number of pairs of crossing faces, degenerate ones left out; stops at stop_at.
std::int64_t count_crossings(std::span<const TestFace> faces, std::int64_t stop_at);

}  // namespace glint

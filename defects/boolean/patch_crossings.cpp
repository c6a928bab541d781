// SPDX-License-Identifier: GPL-3.0-or-later
//
// Do two triangles cross? Signs of volumes are first computed in double with a bound of their
// rounding error; only where that leaves a doubt are CGAL's exact predicates asked (a filtered
// predicate, as in J. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust
// geometric predicates", 1997). Triangles that share corners or an edge may touch there and nowhere
// else. docs/theory/imprint.md, "Acceptance". Cost: some fifty operations for most pairs.
#include "defects/boolean/patch_crossings.h"

#include <cmath>

#include <Eigen/Geometry>

namespace glint {
namespace {

using Eigen::Vector3d;

/// A product of three differences of doubles is off by at most about 1e-15 of the product of their
/// lengths; ten times that decides nothing wrongly.
constexpr double kRounding = 1e-14;

/// A plane through `origin`; normal is exact to kRounding * scale.
struct Plane {
  Vector3d origin;
  Vector3d normal;
  double scale = 0.0;

  /// +1 or -1: certainly on that side, 0: on it or too close to tell.
  int side(const Vector3d& point) const {
    const Vector3d offset = point - origin;
    const double height = normal.dot(offset);
    const double limit =
        kRounding * scale * (std::abs(offset.x()) + std::abs(offset.y()) + std::abs(offset.z()));
    return height > limit ? 1 : height < -limit ? -1 : 0;
  }
};

Plane plane_of(const TestFace& face) {
  return {face.corners[0], face.normal, face.normal_scale};
}

/// Contains an edge that starts at `origin` and stands upright on the face.
Plane upright(const TestFace& face, const Vector3d& origin, const Vector3d& edge) {
  const double scale = face.normal_scale * edge.norm();
  return {origin, face.normal.cross(edge), scale};
}

bool all_on_one_side(const Plane& plane, const Corners& points) {
  const int side = plane.side(points[0]);
  return side != 0 && plane.side(points[1]) == side && plane.side(points[2]) == side;
}

/// Faces without a common corner: is there an upright plane on an edge of `a` that has `b` on its
/// outer side?
bool edge_separates(const TestFace& a, const TestFace& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d& from = a.corners[k];
    const Plane plane = upright(a, from, a.corners[(k + 1) % 3] - from);
    const int inner = plane.side(a.corners[(k + 2) % 3]);
    const int outer = plane.side(b.corners[0]);
    if (inner != 0 && outer == -inner && all_on_one_side(plane, b.corners)) {
      return true;
    }
  }
  return false;
}

/// Corner 0 is common: is there an upright plane on an edge of `a` from it that has `b` outside?
bool corner_separates(const TestFace& a, const Corners& pa, const Corners& pb) {
  for (std::size_t k = 1; k < 3; ++k) {
    const Plane plane = upright(a, pa[0], pa[k] - pa[0]);
    const int inner = plane.side(pa[3 - k]);
    const int outer = plane.side(pb[1]);
    if (inner != 0 && outer == -inner && plane.side(pb[2]) == outer) {
      return true;
    }
  }
  return false;
}

bool cross_at_corner(const TestFace& a, const TestFace& b, const Corners& pa, const Corners& pb) {
  const Plane plane_a = plane_of(a);
  const Plane plane_b = plane_of(b);
  const int side_b = plane_a.side(pb[1]);
  const int side_a = plane_b.side(pa[1]);
  if ((side_b != 0 && plane_a.side(pb[2]) == side_b) ||
      (side_a != 0 && plane_b.side(pa[2]) == side_a)) {
    return false;
  }
  if (corner_separates(a, pa, pb) || corner_separates(b, pb, pa)) {
    return false;
  }
  return triangles_cross_at_corner(pa, pb);
}

bool cross_at_edge(const TestFace& a, const Corners& pa, const Corners& pb) {
  if (plane_of(a).side(pb[2]) != 0) {
    return false;
  }
  const Plane plane = upright(a, pa[0], pa[1] - pa[0]);
  const int inner = plane.side(pa[2]);
  if (inner != 0 && plane.side(pb[2]) == -inner) {
    return false;
  }
  return triangles_cross_at_edge(pa, pb);
}

/// Which corners two faces share.
struct Shared {
  std::size_t count = 0;
  std::array<std::size_t, 3> in_a = {};
  std::array<std::size_t, 3> in_b = {};
};

Shared shared_corners(const Triangle& a, const Triangle& b) {
  Shared shared;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (a[i] == b[j] && shared.count < 3) {
        shared.in_a[shared.count] = i;
        shared.in_b[shared.count++] = j;
      }
    }
  }
  return shared;
}

/// The corners with the shared ones, one or two, first.
Corners reordered(const Corners& c, const std::array<std::size_t, 3>& shared, std::size_t count) {
  const std::size_t first = shared[0];
  const std::size_t second = count == 2 ? shared[1] : (first + 1) % 3;
  return {c[first], c[second], c[3 - first - second]};
}

}  // namespace

TestFace::TestFace(const Triangle& indices, const Corners& points) : ids(indices), corners(points) {
  const Vector3d e1 = points[1] - points[0];
  const Vector3d e2 = points[2] - points[0];
  normal = e1.cross(e2);
  normal_scale = std::sqrt(e1.squaredNorm() * e2.squaredNorm());
}

int orientation(const TestFace& face, const Vector3d& point) {
  const int side = plane_of(face).side(point);
  return side != 0 ? side
                   : exact_orientation(face.corners[0], face.corners[1], face.corners[2], point);
}

int orientation(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  const Vector3d e1 = b - a;
  const Vector3d e2 = c - a;
  const Plane plane = {a, e1.cross(e2), std::sqrt(e1.squaredNorm() * e2.squaredNorm())};
  const int side = plane.side(d);
  return side != 0 ? side : exact_orientation(a, b, c, d);
}

bool is_degenerate(const TestFace& face) {
  if (face.normal.norm() > kRounding * face.normal_scale) {
    return false;
  }
  return are_collinear(face.corners);
}

bool may_intersect(const TestFace& a, const TestFace& b) {
  return !all_on_one_side(plane_of(a), b.corners) && !all_on_one_side(plane_of(b), a.corners);
}

bool faces_cross(const TestFace& a, const TestFace& b) {
  const Shared shared = shared_corners(a.ids, b.ids);
  if (shared.count == 3) {
    return true;
  }
  if (shared.count == 0) {
    return may_intersect(a, b) && !edge_separates(a, b) && !edge_separates(b, a) &&
           triangles_intersect(a.corners, b.corners);
  }
  const Corners pa = reordered(a.corners, shared.in_a, shared.count);
  const Corners pb = reordered(b.corners, shared.in_b, shared.count);
  return shared.count == 1 ? cross_at_corner(a, b, pa, pb) : cross_at_edge(a, pa, pb);
}

std::int64_t count_crossings(std::span<const TestFace> faces, std::int64_t stop_at) {
  std::vector<FloatBox> boxes;
  std::vector<std::uint8_t> is_flat(faces.size());
  boxes.reserve(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    boxes.push_back(faces[i].box());
    is_flat[i] = is_degenerate(faces[i]) ? 1 : 0;
  }
  const BoxTree tree(boxes);
  std::int64_t count = 0;
  for (std::size_t i = 0; i < faces.size() && count < stop_at; ++i) {
    if (is_flat[i] != 0) {
      continue;
    }
    tree.visit(boxes[i], [&](std::int32_t other) {
      const auto j = static_cast<std::size_t>(other);
      if (j > i && is_flat[j] == 0 && count < stop_at && faces_cross(faces[i], faces[j])) {
        ++count;
      }
    });
  }
  return count;
}

}  // namespace glint

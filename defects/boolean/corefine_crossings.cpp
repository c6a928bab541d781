// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the edges of each surface cross the faces of the other. Exact signs of the volume of four
// points decide what crosses what; a sign of zero (a corner on a face, two edges that meet)
// declines the whole operation instead of guessing. Only the places of crossings are rounded, once
// per edge and face, so that both surfaces get the same coordinates; crossings too close to be
// ordered decline as well. Own method: docs/theory/imprint.md, "Cutting". Cost: some dozen signs
// per pair of faces whose boxes meet; memory linear in the crossings.
#include "defects/boolean/corefine_crossings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <Eigen/Geometry>

#include "core/index.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Nodes that follow each other on an edge closer than this part of it are left to exact
/// arithmetic.
constexpr double kMinStep = 1e-11;

/// Finds all crossings.
class Crossings {
 public:
  Crossings(CutSide& first, CutSide& second, std::size_t num_pairs)
      : sides_{&first, &second}, table_(2 * num_pairs + 1) {}

  /// False when the two faces touch in a special way.
  bool add_pair(std::int32_t a, std::int32_t b) {
    num_found_ = 0;
    if (!cross_edges(0, a, b) || !cross_edges(1, b, a)) {
      return false;
    }
    if (num_found_ == 0) {
      return true;
    }
    if (num_found_ != 2) {
      return false;
    }
    sides_[0]->segments.push_back({a, found_[0], found_[1]});
    sides_[1]->segments.push_back({b, found_[0], found_[1]});
    return true;
  }

  const std::vector<Vector3d>& points() const { return points_mm_; }

 private:
  /// The edges of a face of side `which` that cross a face of the other one.
  bool cross_edges(std::size_t which, std::int32_t face, std::int32_t other) {
    const TestFace& mine = sides_[which]->surface.tests[index(face)];
    const TestFace& plane = sides_[1 - which]->surface.tests[index(other)];
    std::array<int, 3> sides = {};
    for (std::size_t k = 0; k < 3; ++k) {
      sides[k] = orientation(plane, mine.corners[k]);
      if (sides[k] == 0) {
        return false;
      }
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (sides[k] == sides[(k + 1) % 3]) {
        continue;
      }
      const int hit = crosses(mine.corners[k], mine.corners[(k + 1) % 3], plane.corners);
      if (hit < 0) {
        return false;
      }
      if (hit > 0 && !add_node(which, 3 * face + static_cast<std::int32_t>(k), other)) {
        return false;
      }
    }
    return true;
  }

  /// 1 or 0: the line through two points passes inside or outside the triangle; -1: special.
  static int crosses(const Vector3d& from, const Vector3d& to, const Corners& c) {
    const int first = orientation(from, to, c[0], c[1]);
    const int second = orientation(from, to, c[1], c[2]);
    const int third = orientation(from, to, c[2], c[0]);
    if (first == 0 || second == 0 || third == 0) {
      return -1;
    }
    return first == second && second == third ? 1 : 0;
  }

  bool add_node(std::size_t which, std::int32_t corner, std::int32_t other) {
    if (num_found_ == 2) {
      return false;
    }
    const std::int32_t edge = sides_[which]->edge_of(corner);
    const std::uint64_t key = edge_key(2 * edge + static_cast<std::int32_t>(which), other);
    const auto fresh = static_cast<std::int32_t>(points_mm_.size());
    const std::int32_t node = table_.at(key, fresh);
    found_[num_found_++] = node;
    if (node == fresh) {
      place_node(*sides_[which], edge, sides_[1 - which]->surface.tests[index(other)], node);
    }
    return true;
  }

  void place_node(CutSide& side, std::int32_t edge, const TestFace& face, std::int32_t node) {
    const Vector3d& from = side.point(edge);
    const Vector3d& to = side.point(next_corner(edge));
    const double before = std::abs(face.normal.dot(from - face.corners[0]));
    const double after = std::abs(face.normal.dot(to - face.corners[0]));
    const double position = before / (before + after);
    points_mm_.emplace_back(position < 0.5 ? from + position * (to - from)
                                           : to + (after / (before + after)) * (from - to));
    side.nodes.push_back({edge, position, node});
  }

  std::array<CutSide*, 2> sides_;
  KeyTable table_;
  std::vector<Vector3d> points_mm_;
  std::array<std::int32_t, 2> found_ = {};
  std::size_t num_found_ = 0;
};

/// Sorts; false when nodes of an edge are too close to each other or to its ends.
bool order_nodes(std::vector<EdgeNode>& nodes) {
  std::sort(nodes.begin(), nodes.end(), [](const EdgeNode& a, const EdgeNode& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.position < b.position;
  });
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const bool is_first = i == 0 || nodes[i].edge != nodes[i - 1].edge;
    const double before = is_first ? 0.0 : nodes[i - 1].position;
    if (!(nodes[i].position - before > kMinStep) || !(nodes[i].position < 1.0 - kMinStep)) {
      return false;
    }
  }
  return true;
}

void sort_segments(std::vector<FaceSegment>& segments) {
  std::sort(segments.begin(), segments.end(), [](const FaceSegment& a, const FaceSegment& b) {
    return std::tie(a.face, a.from, a.to) < std::tie(b.face, b.from, b.to);
  });
}

}  // namespace

std::optional<SurfaceCrossings> find_crossings(
    const GeneralSurface& first,
    const GeneralSurface& second,
    const std::vector<std::pair<std::int32_t, std::int32_t>>& pairs) {
  SurfaceCrossings found(first, second);
  Crossings crossings(found.first, found.second, pairs.size());
  for (const auto& [a, b] : pairs) {
    if (!crossings.add_pair(a, b)) {
      return std::nullopt;
    }
  }
  if (!order_nodes(found.first.nodes) || !order_nodes(found.second.nodes)) {
    return std::nullopt;
  }
  sort_segments(found.first.segments);
  sort_segments(found.second.segments);
  found.points_mm = crossings.points();
  return found;
}

}  // namespace glint

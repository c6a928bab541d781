// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangulates a polygon with holes by clipping ears, after connecting each hole to the outside by
// a bridge (D. Eberly, "Triangulation by ear clipping", 2002); the ear of the best shape goes
// first, to keep needles away. Coordinates are rounded, so a turn counts only when it exceeds what
// rounding can cause, and a polygon that cannot be triangulated that way is declined.
// docs/theory/imprint.md, "Cutting". Cost: quadratic in the corners, which are few; memory linear.
#include "defects/boolean/corefine_polygon.h"

#include <algorithm>
#include <limits>

#include "core/index.h"

namespace glint {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The points, and how far rounding can have moved them from lines they were meant to lie on.
struct RoundedPoints {
  explicit RoundedPoints(const std::vector<Vector2d>& all) : points(all) {
    constexpr double kManyUnits = 64.0 * std::numeric_limits<double>::epsilon();
    for (const Vector2d& point : points) {
      error = std::max(error, kManyUnits * point.cwiseAbs().maxCoeff());
    }
  }

  const Vector2d& operator[](std::int32_t number) const { return points[index(number)]; }

  /// +1 when c lies clearly to the left of the line from a to b, -1 to the right, 0 near the line.
  int side(const Vector2d& a, const Vector2d& b, const Vector2d& c) const {
    const Vector2d along = b - a;
    const Vector2d offset = c - a;
    const double area = cross(along, offset);
    const double limit = error * (along.lpNorm<1>() + offset.lpNorm<1>());
    return area > limit ? 1 : area < -limit ? -1 : 0;
  }

  /// Do two segments without a common corner touch or cross, or come too close to tell?
  bool segments_intersect(const Vector2d& a,
                          const Vector2d& b,
                          const Vector2d& c,
                          const Vector2d& d) const {
    return side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0;
  }

  const std::vector<Vector2d>& points;
  double error = 0.0;
};

/// A polygon of which corners are cut off one by one.
class EarClipper {
 public:
  EarClipper(const RoundedPoints& points, const Polygon& polygon)
      : points_(points), polygon_(polygon) {
    const auto size = static_cast<std::int32_t>(polygon.size());
    for (std::int32_t i = 0; i < size; ++i) {
      previous_.push_back((i + size - 1) % size);
      next_.push_back((i + 1) % size);
    }
  }

  bool run(std::vector<Triangle>& triangles) {
    quality_.assign(polygon_.size(), kGone);
    std::size_t left = polygon_.size();
    rate_all();
    while (left > 3) {
      std::int32_t best = best_ear();
      if (quality_[index(best)] <= 0.0) {
        rate_all();  // a corner that was in the way may be gone
        best = best_ear();
        if (quality_[index(best)] <= 0.0) {
          return false;
        }
      }
      clip(best, triangles);
      --left;
    }
    const std::int32_t last = best_ear();
    if (shape(last) <= 0.0) {
      return false;
    }
    triangles.push_back(triangle(last));
    return true;
  }

 private:
  static constexpr double kGone = -1.0;

  const Vector2d& point(std::int32_t corner) const { return points_[polygon_[index(corner)]]; }

  Triangle triangle(std::int32_t corner) const {
    return {polygon_[index(previous_[index(corner)])],
            polygon_[index(corner)],
            polygon_[index(next_[index(corner)])]};
  }

  /// Doubled area over the square of the longest edge; 0 unless clearly counter-clockwise.
  double shape(std::int32_t corner) const {
    const Vector2d& a = point(previous_[index(corner)]);
    const Vector2d& b = point(corner);
    const Vector2d& c = point(next_[index(corner)]);
    if (points_.side(a, b, c) <= 0) {
      return 0.0;
    }
    const double longest =
        std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    return cross(b - a, c - a) / longest;
  }

  /// Is another corner in the triangle, or on its edge?
  bool is_blocked(std::int32_t corner) const {
    const Triangle ear = triangle(corner);
    const Vector2d& a = points_[ear[0]];
    const Vector2d& b = points_[ear[1]];
    const Vector2d& c = points_[ear[2]];
    const Vector2d margin = Vector2d::Constant(points_.error);
    const Vector2d low = a.cwiseMin(b).cwiseMin(c) - margin;
    const Vector2d high = a.cwiseMax(b).cwiseMax(c) + margin;
    const std::int32_t end = previous_[index(corner)];
    for (std::int32_t i = next_[index(next_[index(corner)])]; i != end; i = next_[index(i)]) {
      const Vector2d& p = point(i);
      const std::int32_t number = polygon_[index(i)];
      if (p.x() < low.x() || p.x() > high.x() || p.y() < low.y() || p.y() > high.y() ||
          number == ear[0] || number == ear[1] || number == ear[2]) {
        continue;
      }
      if (points_.side(a, b, p) >= 0 && points_.side(b, c, p) >= 0 && points_.side(c, a, p) >= 0) {
        return true;
      }
    }
    return false;
  }

  void rate(std::int32_t corner) {
    const double quality = shape(corner);
    quality_[index(corner)] = quality > 0.0 && is_blocked(corner) ? 0.0 : quality;
  }

  void rate_all() {
    const std::int32_t start = first_;
    std::int32_t corner = start;
    do {
      rate(corner);
      corner = next_[index(corner)];
    } while (corner != start);
  }

  std::int32_t best_ear() const {
    std::int32_t best = first_;
    for (std::int32_t i = next_[index(first_)]; i != first_; i = next_[index(i)]) {
      if (quality_[index(i)] > quality_[index(best)]) {
        best = i;
      }
    }
    return best;
  }

  void clip(std::int32_t corner, std::vector<Triangle>& triangles) {
    triangles.push_back(triangle(corner));
    const std::int32_t before = previous_[index(corner)];
    const std::int32_t after = next_[index(corner)];
    next_[index(before)] = after;
    previous_[index(after)] = before;
    quality_[index(corner)] = kGone;
    first_ = before;
    rate(before);
    rate(after);
  }

  const RoundedPoints& points_;
  const Polygon& polygon_;
  std::vector<std::int32_t> previous_;
  std::vector<std::int32_t> next_;
  std::vector<double> quality_;
  std::int32_t first_ = 0;
};

/// Joins holes to a polygon by edges that run there and back.
class Bridges {
 public:
  Bridges(const RoundedPoints& points, Polygon outer, std::vector<Polygon> holes)
      : points_(points), polygon_(std::move(outer)), holes_(std::move(holes)) {}

  bool run() {
    while (!holes_.empty()) {
      if (!join_last_hole()) {
        return false;
      }
      holes_.pop_back();
    }
    return true;
  }

  const Polygon& polygon() const { return polygon_; }

 private:
  struct Bridge {
    double length_sq = 0.0;
    std::size_t outer = 0;  ///< place in polygon_
    std::size_t hole = 0;   ///< place in the hole
  };

  const Vector2d& point(std::int32_t index) const { return points_[index]; }

  /// Per corner of the polygon the nearest corner of the hole, the shortest first.
  std::vector<Bridge> candidates(const Polygon& hole) const {
    std::vector<Bridge> bridges;
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      Bridge best{1e300, i, 0};
      for (std::size_t j = 0; j < hole.size(); ++j) {
        const double length_sq = (point(polygon_[i]) - point(hole[j])).squaredNorm();
        if (length_sq < best.length_sq) {
          best.length_sq = length_sq;
          best.hole = j;
        }
      }
      bridges.push_back(best);
    }
    std::stable_sort(bridges.begin(), bridges.end(), [](const Bridge& a, const Bridge& b) {
      return a.length_sq < b.length_sq;
    });
    return bridges;
  }

  bool crosses(const Polygon& polygon, std::int32_t from, std::int32_t to) const {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const std::int32_t a = polygon[i];
      const std::int32_t b = polygon[(i + 1) % polygon.size()];
      if (a == from || a == to || b == from || b == to) {
        continue;
      }
      if (points_.segments_intersect(point(from), point(to), point(a), point(b))) {
        return true;
      }
    }
    return false;
  }

  /// Does the direction to a point lie inside the polygon's angle at a corner?
  bool starts_inside(std::size_t corner, const Vector2d& to) const {
    const std::size_t size = polygon_.size();
    const Vector2d& before = point(polygon_[(corner + size - 1) % size]);
    const Vector2d& here = point(polygon_[corner]);
    const Vector2d& after = point(polygon_[(corner + 1) % size]);
    const bool left_of_next = points_.side(here, after, to) > 0;
    const bool left_of_last = points_.side(before, here, to) > 0;
    return points_.side(before, here, after) >= 0 ? left_of_next && left_of_last
                                                  : left_of_next || left_of_last;
  }

  bool join_last_hole() {
    const Polygon hole = holes_.back();
    for (const Bridge& bridge : candidates(hole)) {
      const std::int32_t from = polygon_[bridge.outer];
      const std::int32_t to = hole[bridge.hole];
      const bool is_free = starts_inside(bridge.outer, point(to)) && !crosses(polygon_, from, to) &&
                           std::none_of(holes_.begin(), holes_.end(), [&](const Polygon& other) {
                             return crosses(other, from, to);
                           });
      if (!is_free) {
        continue;
      }
      Polygon inserted;
      for (std::size_t i = 0; i <= hole.size(); ++i) {
        inserted.push_back(hole[(bridge.hole + i) % hole.size()]);
      }
      inserted.push_back(from);
      polygon_.insert(polygon_.begin() + static_cast<std::ptrdiff_t>(bridge.outer) + 1,
                      inserted.begin(),
                      inserted.end());
      return true;
    }
    return false;
  }

  const RoundedPoints& points_;
  Polygon polygon_;
  std::vector<Polygon> holes_;
};

}  // namespace

double doubled_area(const std::vector<Vector2d>& points, const Polygon& polygon) {
  double sum = 0.0;
  const Vector2d& origin = points[index(polygon[0])];
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    sum += cross(points[index(polygon[i])] - origin,
                 points[index(polygon[(i + 1) % polygon.size()])] - origin);
  }
  return sum;
}

bool is_inside(const std::vector<Vector2d>& points, const Polygon& polygon, const Vector2d& point) {
  bool is_odd = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = points[index(polygon[i])];
    const Vector2d& b = points[index(polygon[(i + 1) % polygon.size()])];
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y())) {
      is_odd = !is_odd;
    }
  }
  return is_odd;
}

bool triangulate(const std::vector<Vector2d>& points,
                 const Polygon& outer,
                 const std::vector<Polygon>& holes,
                 std::vector<Triangle>& triangles) {
  const RoundedPoints rounded(points);
  if (holes.empty()) {
    return EarClipper(rounded, outer).run(triangles);
  }
  Bridges bridges(rounded, outer, holes);
  return bridges.run() && EarClipper(rounded, bridges.polygon()).run(triangles);
}

}  // namespace glint

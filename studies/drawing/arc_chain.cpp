// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/arc_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kStraight = 1e-7;  ///< bulges below it are lines
constexpr double kMaxBulge = 0.6;   ///< arcs of at most 124 degrees

Vector2d left_of(const Vector2d& v) {
  return {-v.y(), v.x()};
}

/// The arc over a chord through the middle one of three points.
Arc arc_through(const Vector2d& from, const Vector2d& middle, const Vector2d& to) {
  // The chord is seen from the middle point under the inscribed angle: pi minus half of the arc's.
  const Vector2d a = middle - from;
  const Vector2d b = to - middle;
  const double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  const double bulge = std::tan(0.5 * turn);
  return {.from_mm = from, .to_mm = to, .bulge = std::abs(bulge) < kStraight ? 0.0 : bulge};
}

double distance_mm(const Arc& arc, const Vector2d& point) {
  if (arc.bulge != 0.0) {
    return std::abs((point - arc.centre()).norm() - arc.radius_mm());
  }
  const Vector2d chord = arc.to_mm - arc.from_mm;
  return std::abs(left_of(chord).dot(point - arc.from_mm)) / std::max(1e-12, chord.norm());
}

/// Whether one arc may stand for the points from one index to another.
bool fits(const std::vector<Vector2d>& points,
          std::size_t from,
          std::size_t to,
          double tolerance_mm,
          Arc& arc) {
  arc = arc_through(points[from], points[(from + to) / 2], points[to]);
  return std::abs(arc.bulge) <= kMaxBulge &&
         std::all_of(points.begin() + static_cast<std::ptrdiff_t>(from) + 1,
                     points.begin() + static_cast<std::ptrdiff_t>(to),
                     [&](const Vector2d& p) { return distance_mm(arc, p) <= tolerance_mm; });
}

}  // namespace

double Arc::angle_rad() const {
  return 4.0 * std::atan(std::abs(bulge));
}

double Arc::radius_mm() const {
  if (bulge == 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  return 0.25 * (to_mm - from_mm).norm() * (1.0 / std::abs(bulge) + std::abs(bulge));
}

Vector2d Arc::centre() const {
  // From the chord's middle to the left of the way by (1 - bulge^2) / (4 bulge) chords.
  const Vector2d chord = to_mm - from_mm;
  return 0.5 * (from_mm + to_mm) + (1.0 / bulge - bulge) * 0.25 * left_of(chord);
}

Vector2d Arc::highest() const {
  return 0.5 * (from_mm + to_mm) - 0.5 * bulge * left_of(to_mm - from_mm);
}

std::vector<Arc> arcs_through(const std::vector<Vector2d>& points, double tolerance_mm) {
  GLINT_CHECK(points.size() >= 2, "a curve has two points");
  std::vector<Arc> arcs;
  std::size_t from = 0;
  while (from + 1 < points.size()) {
    Arc last = {.from_mm = points[from], .to_mm = points[from + 1]};
    std::size_t to = from + 1;
    Arc next;
    while (to + 1 < points.size() && fits(points, from, to + 1, tolerance_mm, next)) {
      last = next;
      ++to;
    }
    arcs.push_back(last);
    from = to;
  }
  return arcs;
}

Arc mirrored(const Arc& arc) {
  return {.from_mm = {-arc.from_mm.x(), arc.from_mm.y()},
          .to_mm = {-arc.to_mm.x(), arc.to_mm.y()},
          .bulge = -arc.bulge};
}

}  // namespace glint

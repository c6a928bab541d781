// SPDX-License-Identifier: GPL-3.0-or-later
//
// Frames come from the path's own tangents and normals, interpolated between its points, not
// transported along it: a tool stands on the surface everywhere. Where the path bends too sharply
// for a section, the frame is averaged over a window, nine places of it. A path is cut where it has
// turned by 2.75 rad (157 degrees) to one side, since the ends of a tool would meet behind the
// part. docs/theory/imprint.md, "Tools".
#include "defects/tools/line_frames.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace glint {
namespace {

constexpr double kMaxTurn_rad = 2.75;
constexpr int kWindowSamples = 4;  ///< to each side

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double turn_between(const SurfacePathPoint& a, const SurfacePathPoint& b) {
  return std::max(angle_between(a.tangent, b.tangent), angle_between(a.normal, b.normal));
}

/// The index, from the place towards one end, where the path has turned too far; or that end.
std::size_t far_end(const std::vector<SurfacePathPoint>& path, std::size_t from, bool forwards) {
  double turn = 0.0;
  std::size_t at = from;
  const std::size_t end = forwards ? path.size() - 1 : 0;
  while (at != end) {
    const std::size_t next = forwards ? at + 1 : at - 1;
    turn += turn_between(path[at], path[next]);
    if (turn > kMaxTurn_rad) {
      break;
    }
    at = next;
  }
  return at;
}

}  // namespace

LineFrames::LineFrames(std::span<const SurfacePathPoint> path, const SurfacePlace& place)
    : place_(place) {
  for (const SurfacePathPoint& point : path) {
    // Equal places would make a step of no length.
    if (path_.empty() || point.arc_mm > path_.back().arc_mm) {
      path_.push_back(point);
    }
  }
  if (path_.size() < 2) {
    path_.clear();
    return;
  }
  cut_long_turns();
  for (std::size_t i = 1; i < path_.size(); ++i) {
    const double turn = turn_between(path_[i - 1], path_[i]);
    const double step = path_[i].arc_mm - path_[i - 1].arc_mm;
    largest_bend_per_mm_ = std::max(largest_bend_per_mm_, turn / step);
  }
}

void LineFrames::cut_long_turns() {
  std::size_t middle = 0;
  for (std::size_t i = 1; i < path_.size(); ++i) {
    if (std::abs(path_[i].arc_mm) < std::abs(path_[middle].arc_mm)) {
      middle = i;
    }
  }
  const std::size_t first = far_end(path_, middle, false);
  const std::size_t last = far_end(path_, middle, true);
  if (first == last || (first == middle && middle > 0) ||
      (last == middle && middle + 1 < path_.size())) {
    path_.clear();  // a step turns more than a whole side may: no path to follow
    return;
  }
  if (first > 0) {
    half_length_mm_ = -path_[first].arc_mm;
  }
  if (last + 1 < path_.size()) {
    half_length_mm_ = std::min(half_length_mm_, path_[last].arc_mm);
  }
  path_.erase(path_.begin() + static_cast<std::ptrdiff_t>(last) + 1, path_.end());
  path_.erase(path_.begin(), path_.begin() + static_cast<std::ptrdiff_t>(first));
}

SurfacePathPoint LineFrames::interpolated(double arc_mm) const {
  if (path_.size() < 2) {
    return {.arc_mm = arc_mm,
            .point_mm = place_.centre_mm + arc_mm * place_.u_axis,
            .normal = place_.normal,
            .tangent = place_.u_axis};
  }
  const double inside = std::clamp(arc_mm, path_.front().arc_mm, path_.back().arc_mm);
  const auto above = std::upper_bound(
      path_.begin() + 1, path_.end() - 1, inside, [](double arc, const SurfacePathPoint& p) {
        return arc < p.arc_mm;
      });
  const SurfacePathPoint& b = *above;
  const SurfacePathPoint& a = *(above - 1);
  const double share = (inside - a.arc_mm) / (b.arc_mm - a.arc_mm);
  SurfacePathPoint p;
  p.tangent = ((1.0 - share) * a.tangent + share * b.tangent).normalized();
  p.normal = (1.0 - share) * a.normal + share * b.normal;
  p.normal = (p.normal - p.normal.dot(p.tangent) * p.tangent).normalized();
  p.point_mm = (1.0 - share) * a.point_mm + share * b.point_mm + (arc_mm - inside) * p.tangent;
  p.arc_mm = arc_mm;
  return p;
}

LineFrame LineFrames::at(double arc_mm, double window_mm) const {
  const SurfacePathPoint here = interpolated(arc_mm);
  Eigen::Vector3d normal = here.normal;
  Eigen::Vector3d tangent = here.tangent;
  if (!is_straight() && window_mm > 0.0) {
    for (int i = 1; i <= kWindowSamples; ++i) {
      const double step = window_mm * i / kWindowSamples;
      const SurfacePathPoint before = interpolated(arc_mm - step);
      const SurfacePathPoint after = interpolated(arc_mm + step);
      normal += before.normal + after.normal;
      tangent += before.tangent + after.tangent;
    }
  }
  LineFrame frame;
  frame.point_mm = here.point_mm;
  frame.normal = normal.norm() > 1e-6 ? normal.normalized() : here.normal;
  tangent -= tangent.dot(frame.normal) * frame.normal;
  frame.tangent = tangent.norm() > 1e-6 ? tangent.normalized() : frame.normal.unitOrthogonal();
  frame.across = frame.normal.cross(frame.tangent);
  return frame;
}

}  // namespace glint

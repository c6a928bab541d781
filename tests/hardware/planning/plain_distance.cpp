// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/planning/plain_distance.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <string_view>

namespace glint {
namespace {

using Eigen::Vector3d;

double point_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d way = b - a;
  const double square = way.squaredNorm();
  const double share = square > 0.0 ? std::clamp(way.dot(p - a) / square, 0.0, 1.0) : 0.0;
  return (a + share * way - p).norm();
}

/// The point's foot lies within the triangle: its distance to the plane, else infinity.
double point_face(const Vector3d& p, const Corners& t) {
  const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
  if (normal.norm() < 1e-9) {
    return std::numeric_limits<double>::infinity();
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (normal.dot((t[(i + 1) % 3] - t[i]).cross(p - t[i])) < 0.0) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return std::abs(normal.normalized().dot(p - t[0]));
}

bool goes_through(const Vector3d& a, const Vector3d& b, const Corners& t) {
  const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double from = normal.dot(a - t[0]);
  const double to = normal.dot(b - t[0]);
  if (from * to > 0.0 || from == to) {
    return false;
  }
  const Vector3d p = a + from / (from - to) * (b - a);
  for (std::size_t i = 0; i < 3; ++i) {
    if (normal.dot((t[(i + 1) % 3] - t[i]).cross(p - t[i])) < 0.0) {
      return false;
    }
  }
  return normal.norm() > 1e-9;
}

Corners corners_of(const SolidBody& body, std::size_t i, const Eigen::Isometry3d& base_from_body) {
  return {base_from_body * body.mesh.vertex(i, 0),
          base_from_body * body.mesh.vertex(i, 1),
          base_from_body * body.mesh.vertex(i, 2)};
}

double body_distance(const SolidBody& body,
                     const Eigen::Isometry3d& base_from_body,
                     const SolidBody& other,
                     const Eigen::Isometry3d& base_from_other) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < body.mesh.num_triangles(); ++i) {
    const Corners first = corners_of(body, i, base_from_body);
    for (std::size_t k = 0; k < other.mesh.num_triangles(); ++k) {
      least = std::min(least, triangle_distance(first, corners_of(other, k, base_from_other)));
    }
  }
  return least - body.radius_mm - other.radius_mm;
}

bool can_meet(const SolidBody& low, const SolidBody& high) {
  const bool is_carried = high.kind == SolidBody::Kind::kCarried;
  const bool is_at_end = is_carried || high.name == "tool";
  const auto is_low_one_of = [&low](std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, std::string_view(low.name)) != names.end();
  };
  return (is_low_one_of({"base", "shoulder", "upper arm", "elbow"}) &&
          (is_at_end || high.name == "wrist 3")) ||
         (is_low_one_of({"forearm"}) && is_at_end) ||
         (is_low_one_of({"wrist 1", "wrist 2"}) && is_carried);
}

}  // namespace

double segment_distance(const Vector3d& a,
                        const Vector3d& b,
                        const Vector3d& c,
                        const Vector3d& d) {
  double least = std::min({point_segment(a, c, d),
                           point_segment(b, c, d),
                           point_segment(c, a, b),
                           point_segment(d, a, b)});
  const Vector3d u = b - a;
  const Vector3d v = d - c;
  const double uv = u.dot(v);
  const double det = u.squaredNorm() * v.squaredNorm() - uv * uv;
  if (det > 1e-12) {
    const Vector3d w = c - a;
    const double s = (w.dot(u) * v.squaredNorm() - w.dot(v) * uv) / det;
    const double t = (w.dot(u) * uv - w.dot(v) * u.squaredNorm()) / det;
    if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) {
      least = std::min(least, (a + s * u - c - t * v).norm());
    }
  }
  return least;
}

double triangle_distance(const Corners& first, const Corners& second) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    if (goes_through(first[i], first[(i + 1) % 3], second) ||
        goes_through(second[i], second[(i + 1) % 3], first)) {
      return 0.0;
    }
    least = std::min({least, point_face(first[i], second), point_face(second[i], first)});
    for (std::size_t k = 0; k < 3; ++k) {
      least = std::min(
          least, segment_distance(first[i], first[(i + 1) % 3], second[k], second[(k + 1) % 3]));
    }
  }
  return least;
}

double plain_margin_mm(const PlanningCell& cell,
                       const std::vector<SolidBody>& bodies,
                       const JointVector& joints_rad,
                       std::string* nearest) {
  const LinkFrames frames = cell.arm.arm.frames(joints_rad);
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](double distance, const std::string& name) {
    if (distance < least) {
      least = distance;
      if (nearest != nullptr) {
        *nearest = name;
      }
    }
  };
  for (const SolidBody& body : bodies) {
    if (body.kind == SolidBody::Kind::kBase || body.kind == SolidBody::Kind::kStanding) {
      continue;
    }
    const Eigen::Isometry3d& pose = frames[static_cast<std::size_t>(body.link)];
    for (const Vector3d& local_mm : body.mesh.vertices_mm) {
      const Vector3d p = pose * local_mm;
      take(p.z() - body.radius_mm - *cell.table_mm, body.name + " to table");
      for (Eigen::Index k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        if (p[k] - body.radius_mm < cell.arm.limits.box_min_mm[axis] ||
            p[k] + body.radius_mm > cell.arm.limits.box_max_mm[axis]) {
          take(0.0, body.name + " out of the box");
        }
      }
    }
    for (const SolidBody& other : bodies) {
      if (other.kind != SolidBody::Kind::kStanding) {
        continue;
      }
      take(body_distance(body, pose, other, Eigen::Isometry3d::Identity()),
           body.name + " to " + other.name);
    }
  }
  return least;
}

double plain_self_mm(const PlanningCell& cell,
                     const std::vector<SolidBody>& bodies,
                     const JointVector& joints_rad,
                     std::string* nearest) {
  const LinkFrames frames = cell.arm.arm.frames(joints_rad);
  double least = std::numeric_limits<double>::infinity();
  for (const SolidBody& low : bodies) {
    for (const SolidBody& high : bodies) {
      if (!can_meet(low, high)) {
        continue;
      }
      const double distance = body_distance(low,
                                            frames[static_cast<std::size_t>(low.link)],
                                            high,
                                            frames[static_cast<std::size_t>(high.link)]);
      if (distance < least) {
        least = distance;
        if (nearest != nullptr) {
          *nearest = low.name + " to " + high.name;
        }
      }
    }
  }
  return least;
}

}  // namespace glint

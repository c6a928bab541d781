// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/surface/surface_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>

#include "core/error.h"
#include "core/index.h"
#include "simulator/geometry/surface/surface_sampling.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// A point that moves on a surface and the direction it moves in.
struct Motion {
  Vector3d p = Vector3d::Zero();
  Vector3d t = Vector3d::UnitX();
};

Vector3d unit_normal(const ExactPatch& patch, const Vector3d& p_mm) {
  Vector3d gradient;
  implicit_value(patch, p_mm, &gradient);
  return gradient.normalized();
}

/// A geodesic bends only along the normal, and stays tangential: t' = -(t . dn/ds) n.
Motion change(const ExactPatch& patch, const Motion& at) {
  constexpr double kSmall_mm = 3e-4;
  const Vector3d turn =
      (unit_normal(patch, at.p + kSmall_mm * at.t) - unit_normal(patch, at.p - kSmall_mm * at.t)) /
      (2.0 * kSmall_mm);
  return {.p = at.t, .t = -at.t.dot(turn) * unit_normal(patch, at.p)};
}

Motion moved(const Motion& from, double step_mm, const Motion& rate) {
  return {.p = from.p + step_mm * rate.p, .t = from.t + step_mm * rate.t};
}

/// One step of the classical Runge-Kutta method of order 4.
Motion runge_kutta(const ExactPatch& patch, const Motion& at, double step_mm) {
  const Motion a = change(patch, at);
  const Motion b = change(patch, moved(at, 0.5 * step_mm, a));
  const Motion c = change(patch, moved(at, 0.5 * step_mm, b));
  const Motion d = change(patch, moved(at, step_mm, c));
  return {.p = at.p + step_mm / 6.0 * (a.p + 2.0 * b.p + 2.0 * c.p + d.p),
          .t = at.t + step_mm / 6.0 * (a.t + 2.0 * b.t + 2.0 * c.t + d.t)};
}

/// Steps small against the radius of curvature: an error of about (1/50)^4 / 120 = 1e-9 of a step.
Motion geodesic(const ExactPatch& patch, Motion at, double length_mm) {
  constexpr double kLargestTurn_rad = 0.02;
  constexpr double kMaxSteps = 1000.0;
  const double turn_rad = length_mm * change(patch, at).t.norm();
  const double steps = std::clamp(std::ceil(turn_rad / kLargestTurn_rad), 1.0, kMaxSteps);
  for (int i = 0; i < static_cast<int>(steps); ++i) {
    at = runge_kutta(patch, at, length_mm / steps);
  }
  return at;
}

/// The direction without its part along the normal.
Vector3d tangential(const Vector3d& direction, const Vector3d& normal) {
  return (direction - direction.dot(normal) * normal).normalized();
}

bool is_sharp(const Vector3d& n, const Vector3d& m) {
  return n.dot(m) < std::cos(kSharpBend_rad);
}

/// Walks on the surface until it ends, then straight on.
class Walker {
 public:
  Walker(const Part& part, const Bvh& bvh, const SurfacePoint& start, const Vector3d& direction)
      : part_(part), bvh_(bvh), at_(start), tangent_(tangential(direction, start.normal)) {}

  void advance(double step_mm) {
    const std::int32_t patch = part_.mesh.patch_of(index(at_.triangle));
    if (!is_off_ && !(patch >= 0 ? advance_on_patch(patch, step_mm) : advance_on_mesh(step_mm))) {
      is_off_ = true;
    }
    if (is_off_) {
      at_.point_mm += step_mm * tangent_;
    }
  }

  SurfacePathPoint point(double arc_mm) const {
    return {.arc_mm = arc_mm,
            .point_mm = at_.point_mm,
            .normal = at_.normal,
            .tangent = arc_mm < 0.0 ? Vector3d(-tangent_) : tangent_};
  }

 private:
  void go_to(const SurfacePoint& next, const Vector3d& direction) {
    at_ = next;
    tangent_ = tangential(direction, next.normal);
  }

  /// False when the triangles end before the step does.
  bool advance_on_patch(std::int32_t patch, double step_mm) {
    // The exact surface lies off its triangles by up to the chord tolerance.
    constexpr double kNear_mm = 3.0 * kChordTolerance_mm;
    const ExactPatch& exact = part_.patches[index(patch)];
    const Motion end = geodesic(exact, {.p = at_.point_mm, .t = tangent_}, step_mm);
    const auto next = onto_patch(exact, end.p, step_mm);
    const auto nearest = bvh_.nearest(part_.mesh, end.p, kNear_mm + 0.5 * step_mm);
    if (!next || !nearest) {
      return false;
    }
    if (part_.mesh.patch_of(index(nearest->triangle)) != patch) {
      const SurfacePoint across = smooth_point(part_, nearest->triangle, nearest->point_mm);
      if (!is_sharp(across.normal, next->normal)) {
        go_to(across, turned(end.t, next->normal, across.normal));
        return true;
      }
    }
    if (nearest->distance_mm > kNear_mm) {
      return false;
    }
    const std::int32_t triangle = at_.triangle;
    const bool is_same = part_.mesh.patch_of(index(nearest->triangle)) == patch;
    go_to(*next, end.t);
    at_.triangle = is_same ? nearest->triangle : triangle;
    return true;
  }

  /// Aims along the tangent, puts that onto the mesh, and aims again until the chord is as long as
  /// the step. False when it stays short (the mesh ends) or the mesh bends sharply.
  bool advance_on_mesh(double step_mm) {
    constexpr int kTries = 4;
    constexpr double kGoodEnough = 1e-4;
    constexpr double kTooShort = 0.02;
    double reach_mm = step_mm;
    double miss = 1.0;
    std::optional<NearestPoint> nearest;
    for (int i = 0; i < kTries && std::abs(miss) > kGoodEnough; ++i) {
      nearest = bvh_.nearest(part_.mesh, at_.point_mm + reach_mm * tangent_, reach_mm);
      if (!nearest) {
        return false;
      }
      const double chord_mm = (nearest->point_mm - at_.point_mm).norm();
      miss = chord_mm / step_mm - 1.0;
      reach_mm *= std::clamp(step_mm / chord_mm, 0.5, 2.0);
    }
    if (std::abs(miss) > kTooShort || is_sharp(face_normal(part_.mesh, index(at_.triangle)),
                                               face_normal(part_.mesh, index(nearest->triangle)))) {
      return false;
    }
    const SurfacePoint next = smooth_point(part_, nearest->triangle, nearest->point_mm);
    go_to(next, turned(tangent_, at_.normal, next.normal));
    return true;
  }

  /// Parallel transport: the least turn that takes one normal to the other.
  static Vector3d turned(const Vector3d& direction, const Vector3d& from, const Vector3d& to) {
    return Eigen::Quaterniond::FromTwoVectors(from, to) * direction;
  }

  const Part& part_;
  const Bvh& bvh_;
  SurfacePoint at_;
  Vector3d tangent_;
  bool is_off_ = false;
};

SurfacePoint start_of(const Part& part, const Bvh& bvh, const SurfacePlace& place) {
  const auto nearest =
      bvh.nearest(part.mesh, place.centre_mm, std::numeric_limits<double>::infinity());
  GLINT_CHECK(nearest.has_value(), "a part has triangles");
  const std::int32_t patch = part.mesh.patch_of(index(nearest->triangle));
  return smooth_point(part, nearest->triangle, patch >= 0 ? place.centre_mm : nearest->point_mm);
}

}  // namespace

std::vector<SurfacePathPoint> surface_path(const Part& part,
                                           const Bvh& bvh,
                                           const SurfacePlace& place,
                                           double half_length_mm,
                                           double step_mm) {
  GLINT_CHECK(half_length_mm >= 0.0 && step_mm > 0.0 && half_length_mm <= 1e6 * step_mm,
              "a path needs a length, and steps that are not too many");
  const auto steps = static_cast<int>(std::ceil(half_length_mm / step_mm));
  const SurfacePoint start = start_of(part, bvh, place);
  std::vector<SurfacePathPoint> path;
  path.reserve(2 * static_cast<std::size_t>(steps) + 1);
  for (const double side : {-1.0, 1.0}) {
    Walker walker(part, bvh, start, side * place.u_axis);
    for (int i = 1; i <= steps; ++i) {
      walker.advance(half_length_mm / steps);
      path.push_back(walker.point(side * half_length_mm * i / steps));
    }
    if (side < 0.0) {
      std::ranges::reverse(path);
      path.push_back(Walker(part, bvh, start, place.u_axis).point(0.0));
    }
  }
  return path;
}

}  // namespace glint

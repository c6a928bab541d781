// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/surface/surface_sampling.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/error.h"
#include "core/index.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// How far an exact patch may lie from its triangles, generously.
constexpr double kMaxMove_mm = 0.1;

/// Weights of the corners at a point of the triangle's plane; (1, 0, 0) without area.
Vector3d barycentrics(const TriangleMesh& mesh, std::size_t triangle, const Vector3d& p) {
  const Vector3d& a = mesh.vertex(triangle, 0);
  const Vector3d e1 = mesh.vertex(triangle, 1) - a;
  const Vector3d e2 = mesh.vertex(triangle, 2) - a;
  const Vector3d normal = e1.cross(e2);
  const double squared = normal.squaredNorm();
  if (!(squared > 0.0)) {
    return Vector3d::UnitX();
  }
  const double u = normal.dot((p - a).cross(e2)) / squared;
  const double v = normal.dot(e1.cross(p - a)) / squared;
  return {1.0 - u - v, u, v};
}

Vector3d shading_normal_at(const TriangleMesh& mesh, std::size_t triangle, const Vector3d& p) {
  if (mesh.corner_normals.empty()) {
    return face_normal(mesh, triangle);
  }
  const Vector3d weights = barycentrics(mesh, triangle, p);
  const Vector3d sum = weights[0] * mesh.normal(triangle, 0) +
                       weights[1] * mesh.normal(triangle, 1) +
                       weights[2] * mesh.normal(triangle, 2);
  const double length = sum.norm();
  return length > 0.0 ? Vector3d(sum / length) : face_normal(mesh, triangle);
}

double area_of(const SurfacePiece& piece) {
  const auto& [a, b, c] = piece.corners_mm;
  return 0.5 * (b - a).cross(c - a).norm();
}

/// Points in a disc of radius 1 that stand for equal areas: the centre and three rings.
std::vector<Eigen::Vector2d> disc_points() {
  constexpr int kRings = 3;
  const auto count_within = [](int ring) { return 1.0 + 3.0 * ring * (ring + 1); };
  std::vector<Eigen::Vector2d> points = {Eigen::Vector2d::Zero()};
  for (int ring = 1; ring <= kRings; ++ring) {
    const double radius =
        std::sqrt(0.5 * (count_within(ring - 1) + count_within(ring)) / count_within(kRings));
    for (int i = 0; i < 6 * ring; ++i) {
      const double angle = 2.0 * kPi * i / (6.0 * ring);
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
  }
  return points;
}

}  // namespace

std::optional<SurfacePoint> onto_patch(const ExactPatch& patch,
                                       const Vector3d& p_mm,
                                       double max_move_mm) {
  constexpr int kMaxSteps = 20;
  const double tolerance_mm = 1e-12 * std::max(1.0, 1e-2 * p_mm.norm());
  Vector3d p = p_mm;
  for (int i = 0; i < kMaxSteps; ++i) {
    Vector3d gradient;
    const double value_mm = implicit_value(patch, p, &gradient);
    const Vector3d step = -value_mm / gradient.squaredNorm() * gradient;
    p += step;
    if (!((p - p_mm).norm() <= max_move_mm)) {  // also when the gradient is zero
      return std::nullopt;
    }
    if (step.norm() <= tolerance_mm) {
      implicit_value(patch, p, &gradient);
      return SurfacePoint{.point_mm = p, .normal = gradient.normalized()};
    }
  }
  return std::nullopt;
}

SurfacePoint smooth_point(const Part& part, std::int32_t triangle, const Vector3d& p_mm) {
  const std::int32_t patch = part.mesh.patch_of(index(triangle));
  if (patch >= 0) {
    if (auto exact = onto_patch(part.patches[index(patch)], p_mm, kMaxMove_mm)) {
      exact->triangle = triangle;
      return *exact;
    }
  }
  return {.point_mm = p_mm,
          .normal = shading_normal_at(part.mesh, index(triangle), p_mm),
          .triangle = triangle};
}

Vector3d footprint_normal(const Part& part,
                          const Bvh& bvh,
                          const SurfacePoint& at,
                          double radius_mm) {
  if (part.mesh.patch_of(index(at.triangle)) >= 0) {
    return at.normal;
  }
  const Vector3d facet = face_normal(part.mesh, index(at.triangle));
  const Vector3d u = at.normal.unitOrthogonal();
  const Vector3d v = at.normal.cross(u);
  Vector3d sum = at.normal;
  for (const Eigen::Vector2d& point : disc_points()) {
    const Vector3d p = at.point_mm + radius_mm * (point.x() * u + point.y() * v);
    const auto nearest = bvh.nearest(part.mesh, p, radius_mm);
    if (nearest &&
        face_normal(part.mesh, index(nearest->triangle)).dot(facet) >= std::cos(kSharpBend_rad)) {
      sum += shading_normal_at(part.mesh, index(nearest->triangle), nearest->point_mm);
    }
  }
  return sum.normalized();
}

SurfacePlace oriented_place(const Part& part,
                            const Vector3d& centre_mm,
                            const Vector3d& normal,
                            double angle_rad) {
  const Eigen::Matrix3d& rotation = part.scene_from_part.rotation;
  const bool is_along_x = std::abs(normal.dot(rotation.col(0))) > 0.999;
  const Vector3d axis = is_along_x ? rotation.col(1) : rotation.col(0);
  const Vector3d u = (axis - axis.dot(normal) * normal).normalized();
  SurfacePlace place = {.centre_mm = centre_mm, .normal = normal};
  place.u_axis = std::cos(angle_rad) * u + std::sin(angle_rad) * normal.cross(u);
  place.v_axis = normal.cross(place.u_axis);
  return place;
}

AreaSampler::AreaSampler(const TriangleMesh& mesh) {
  sums_mm2_.reserve(mesh.num_triangles());
  double sum_mm2 = 0.0;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    sums_mm2_.push_back(sum_mm2 += area_vector(mesh, i).norm());
  }
}

AreaSampler::AreaSampler(const TriangleMesh& mesh, std::vector<std::int32_t> triangles)
    : triangles_(std::move(triangles)) {
  double sum_mm2 = 0.0;
  for (const std::int32_t triangle : triangles_) {
    sums_mm2_.push_back(sum_mm2 += area_vector(mesh, index(triangle)).norm());
  }
}

AreaSampler::AreaSampler(std::vector<SurfacePiece> pieces) : pieces_(std::move(pieces)) {
  double sum_mm2 = 0.0;
  for (const SurfacePiece& piece : pieces_) {
    sums_mm2_.push_back(sum_mm2 += area_of(piece));
  }
}

/// With s = sqrt(r1) the corners' weights 1 - s, s (1 - r2), s r2 are uniform over the triangle.
/// Source: R. Osada et al., "Shape distributions", ACM Transactions on Graphics 21(4), 2002.
AreaSampler::Sample AreaSampler::draw(const TriangleMesh& mesh, Rng& rng) const {
  GLINT_CHECK(area_mm2() > 0.0, "points need a surface to lie on");
  const double wanted_mm2 = rng.uniform() * area_mm2();
  auto chosen = std::ranges::upper_bound(sums_mm2_, wanted_mm2);
  if (chosen == sums_mm2_.end()) {  // the product was rounded up
    chosen = std::ranges::lower_bound(sums_mm2_, area_mm2());
  }
  const auto i = static_cast<std::size_t>(chosen - sums_mm2_.begin());
  const double s = std::sqrt(rng.uniform());
  const double r = rng.uniform();
  const auto mix = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) -> Vector3d {
    return (1.0 - s) * a + s * (1.0 - r) * b + s * r * c;
  };
  if (!pieces_.empty()) {
    const auto& [a, b, c] = pieces_[i].corners_mm;
    return {.triangle = pieces_[i].triangle, .point_mm = mix(a, b, c)};
  }
  const std::int32_t triangle = triangles_.empty() ? static_cast<std::int32_t>(i) : triangles_[i];
  const std::size_t t = index(triangle);
  return {.triangle = triangle,
          .point_mm = mix(mesh.vertex(t, 0), mesh.vertex(t, 1), mesh.vertex(t, 2))};
}

}  // namespace glint

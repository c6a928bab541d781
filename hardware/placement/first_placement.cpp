// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/placement/first_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "core/units.h"
#include "hardware/calibration/rotation.h"
#include "hardware/placement/part_placement.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Candidate {
  Isometry3d pose = Isometry3d::Identity();
  double square_mm2 = std::numeric_limits<double>::infinity();  ///< of the distances from the rays
};

/// Takes a vector to its part across the ray.
Matrix3d across(const PartRay& ray) {
  return Matrix3d::Identity() - ray.direction * ray.direction.transpose();
}

/// The translation that brings the turned points nearest to their rays.
Vector3d best_translation(std::span<const PartRay> rays, const Matrix3d& turn) {
  Matrix3d sum = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const PartRay& ray : rays) {
    const Matrix3d flat = across(ray);
    sum += flat;
    right += flat * (ray.origin_mm - turn * ray.part_mm);
  }
  return sum.fullPivLu().solve(right);
}

double square_at(std::span<const PartRay> rays, const Isometry3d& pose) {
  double square = 0.0;
  for (const PartRay& ray : rays) {
    const Vector3d off = pose * ray.part_mm - ray.origin_mm;
    // Behind the camera the line is near, the ray is not.
    square += off.dot(ray.direction) > 0.0 ? (across(ray) * off).squaredNorm() : off.squaredNorm();
  }
  return square;
}

/// The points of the rays that are nearest to the turned part's points.
std::vector<Vector3d> feet_on_rays(std::span<const PartRay> rays, const Matrix3d& turn) {
  const Vector3d at = best_translation(rays, turn);
  std::vector<Vector3d> feet;
  for (const PartRay& ray : rays) {
    const Vector3d off = turn * ray.part_mm + at - ray.origin_mm;
    feet.emplace_back(ray.origin_mm + std::abs(off.dot(ray.direction)) * ray.direction);
  }
  return feet;
}

/// Turns to the points' feet on their rays, until it stands.
Candidate iterated(std::span<const PartRay> rays, Matrix3d turn) {
  constexpr int kMaxSteps = 200;
  std::vector<Vector3d> part;
  for (const PartRay& ray : rays) {
    part.push_back(ray.part_mm);
  }
  Candidate result;
  for (int step = 0; step < kMaxSteps; ++step) {
    const auto placed = place_by_points(part, feet_on_rays(rays, turn), 1.0);
    if (!placed.has_value()) {
      return result;
    }
    const Matrix3d next = placed->base_from_part.linear();
    const bool stands = angle_rad(turn.transpose() * next) < 1e-9;
    turn = next;
    result.pose.linear() = turn;
    if (stands) {
      break;
    }
  }
  result.pose.translation() = best_translation(rays, turn);
  result.square_mm2 = square_at(rays, result.pose);
  return result;
}

/// The 60 rotations of an icosahedron: no rotation is farther than 45 degrees from the nearest.
std::vector<Matrix3d> even_rotations() {
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  const Vector3d fifth = Vector3d(0.0, 1.0, golden).normalized();
  const Matrix3d by_fifth = rotation_of(2.0 * kPi / 5.0 * fifth);
  const Matrix3d by_third = rotation_of(2.0 * kPi / 3.0 * Vector3d::Ones().normalized());
  std::vector<Matrix3d> group = {Matrix3d::Identity()};
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (const Matrix3d& by : {by_fifth, by_third}) {
      const Matrix3d next = group[i] * by;
      const bool is_known = std::ranges::any_of(
          group, [&](const Matrix3d& one) { return (one - next).norm() < 1e-6; });
      if (!is_known) {
        group.push_back(next);
      }
    }
  }
  return group;
}

}  // namespace

std::vector<Isometry3d> first_placements(std::span<const PartRay> rays) {
  constexpr std::size_t kMax = 4;
  constexpr double kSameRad = 0.02;
  std::vector<Candidate> found;
  for (const Matrix3d& turn : even_rotations()) {
    const Candidate candidate = iterated(rays, turn);
    if (std::isfinite(candidate.square_mm2)) {
      found.push_back(candidate);
    }
  }
  std::ranges::stable_sort(found, {}, &Candidate::square_mm2);
  std::vector<Isometry3d> poses;
  for (const Candidate& candidate : found) {
    const bool is_new = std::ranges::none_of(poses, [&](const Isometry3d& pose) {
      return angle_rad(pose.linear().transpose() * candidate.pose.linear()) < kSameRad;
    });
    if (is_new && poses.size() < kMax) {
      poses.push_back(candidate.pose);
    }
  }
  return poses;
}

}  // namespace glint

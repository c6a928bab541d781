// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/surface/feature_reach.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kReachSigmas = 2.0 * SurfaceDetail::kReachRadii;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double squared_distance(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double squared = along.squaredNorm();
  const double share = squared > 0.0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - a - share * along).squaredNorm();
}

bool do_cross(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0.0 &&
         cross(d - c, a - c) * cross(d - c, b - c) < 0.0;
}

bool is_inside(const std::array<Vector2d, 3>& triangle, const Vector2d& p) {
  const double a = cross(triangle[1] - triangle[0], p - triangle[0]);
  const double b = cross(triangle[2] - triangle[1], p - triangle[1]);
  const double c = cross(triangle[0] - triangle[2], p - triangle[2]);
  return (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
}

/// From a triangle to the line from (-half, 0) to (half, 0); 0 where they meet.
double distance_to_line(const std::array<Vector2d, 3>& triangle, double half) {
  const Vector2d low(-half, 0.0);
  const Vector2d high(half, 0.0);
  if (is_inside(triangle, low) || is_inside(triangle, high)) {
    return 0.0;
  }
  double squared = kInfinity;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector2d& a = triangle[k];
    const Vector2d& b = triangle[(k + 1) % 3];
    if (do_cross(a, b, low, high)) {
      return 0.0;
    }
    squared = std::min({squared,
                        squared_distance(a, low, high),
                        squared_distance(low, a, b),
                        squared_distance(high, a, b)});
  }
  return std::sqrt(squared);
}

/// How far a feature acts: across from its line, along it from its centre, and along its normal.
struct Extent {
  explicit Extent(const HeightFeature& feature)
      : across_mm(kReachSigmas * feature.cross_sigma_mm()),
        along_mm(across_mm + feature.half_line_mm()) {}

  double across_mm;
  double along_mm;
};

BoundingBox feature_box(const HeightFeature& feature) {
  const Extent extent(feature);
  const Vector3d half = extent.along_mm * feature.u_axis.cwiseAbs() +
                        extent.across_mm * feature.v_axis.cwiseAbs() +
                        extent.along_mm * feature.normal.cwiseAbs();
  return {.min_mm = feature.centre_mm - half, .max_mm = feature.centre_mm + half};
}

bool do_overlap(const BoundingBox& a, const BoundingBox& b) {
  return (a.min_mm.array() <= b.max_mm.array()).all() &&
         (b.min_mm.array() <= a.max_mm.array()).all();
}

/// The same rule as SurfaceDetail: a feature acts where the normal points to its side.
bool faces_feature(const HeightFeature& feature, const SurfaceTriangle& triangle) {
  return std::ranges::any_of(triangle.normals,
                             [&](const Vector3d& n) { return n.dot(feature.normal) > 0.0; });
}

/// The longest edge [sigma] a face may have whose nearest point is that far [sigma] from a
/// feature's centre or line; infinite beyond the reach of 5 sigma. See docs/theory/imprint.md.
///
/// A linear face of edge e misses a height with the curvature c by c e^2 / 8 at most. The curvature
/// of a Gaussian at r sigma is (r^2 - 1) exp(-r^2 / 2) of the one at its centre beyond 2 sigma.
double allowed_edge_sigmas(double distance_sigmas, double edges_per_sigma) {
  if (distance_sigmas >= kReachSigmas) {
    return kInfinity;
  }
  constexpr double kFull = 2.0;  // within the radius, where the defect is seen
  constexpr double kCoarsest = 0.5;
  const double finest = 1.0 / edges_per_sigma;
  if (distance_sigmas <= kFull) {
    return finest;
  }
  const auto curvature = [](double r) { return (r * r - 1.0) * std::exp(-0.5 * r * r); };
  return std::clamp(finest * std::sqrt(curvature(kFull) / curvature(distance_sigmas)),
                    finest,
                    std::max(finest, kCoarsest));
}

double allowed_by(const HeightFeature& feature,
                  const SurfaceTriangle& triangle,
                  double edges_per_sigma) {
  if (!faces_feature(feature, triangle)) {
    return kInfinity;
  }
  std::array<Vector2d, 3> flat = {};
  double lowest = kInfinity;
  double highest = -kInfinity;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d d = triangle.points_mm[k] - feature.centre_mm;
    flat[k] = Vector2d(d.dot(feature.u_axis), d.dot(feature.v_axis));
    lowest = std::min(lowest, d.dot(feature.normal));
    highest = std::max(highest, d.dot(feature.normal));
  }
  const Extent extent(feature);
  if (lowest > extent.along_mm || highest < -extent.along_mm) {
    return kInfinity;
  }
  const double sigma_mm = feature.cross_sigma_mm();
  const double distance = distance_to_line(flat, feature.half_line_mm()) / sigma_mm;
  return sigma_mm * allowed_edge_sigmas(distance, edges_per_sigma);
}

}  // namespace

SurfaceTriangle surface_triangle(const TriangleMesh& mesh, std::int32_t face) {
  SurfaceTriangle triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    triangle.points_mm[k] = mesh.vertex(static_cast<std::size_t>(face), k);
    triangle.normals[k] = mesh.normal(static_cast<std::size_t>(face), k);
  }
  return triangle;
}

FeatureReach::FeatureReach(std::span<const HeightFeature> features) : features_(features) {
  for (const HeightFeature& feature : features) {
    boxes_.push_back(feature_box(feature));
    box_.min_mm = box_.min_mm.cwiseMin(boxes_.back().min_mm);
    box_.max_mm = box_.max_mm.cwiseMax(boxes_.back().max_mm);
  }
  cells_.resize(static_cast<std::size_t>(kCells) * kCells * kCells);
  cells_per_mm_ = (box_.size_mm().array().max(1e-9).inverse() * kCells).matrix();
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    visit_cells(boxes_[i],
                [&](std::size_t cell) { cells_[cell].push_back(static_cast<std::int32_t>(i)); });
  }
}

std::array<int, 3> FeatureReach::cell_at(const Vector3d& p_mm) const {
  const Vector3d q = (p_mm - box_.min_mm).cwiseProduct(cells_per_mm_);
  const auto clamped = [](double x) { return static_cast<int>(std::clamp(x, 0.0, kCells - 1.0)); };
  return {clamped(q.x()), clamped(q.y()), clamped(q.z())};
}

template <class Visit>
void FeatureReach::visit_cells(const BoundingBox& box, const Visit& visit) const {
  const std::array<int, 3> low = cell_at(box.min_mm);
  const std::array<int, 3> high = cell_at(box.max_mm);
  for (int z = low[2]; z <= high[2]; ++z) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int x = low[0]; x <= high[0]; ++x) {
        visit(static_cast<std::size_t>((z * kCells + y) * kCells + x));
      }
    }
  }
}

double FeatureReach::allowed_edge_mm(const SurfaceTriangle& triangle,
                                     double edges_per_sigma) const {
  BoundingBox box;
  for (const Vector3d& p : triangle.points_mm) {
    box.min_mm = box.min_mm.cwiseMin(p);
    box.max_mm = box.max_mm.cwiseMax(p);
  }
  double allowed_mm = kInfinity;
  if (!do_overlap(box, box_)) {
    return allowed_mm;
  }
  const auto look_at = [&](std::size_t number) {
    if (do_overlap(box, boxes_[number])) {
      allowed_mm = std::min(allowed_mm, allowed_by(features_[number], triangle, edges_per_sigma));
    }
  };
  const double cells = (box.size_mm().cwiseProduct(cells_per_mm_).array() + 1.0).prod();
  if (cells > static_cast<double>(features_.size())) {
    for (std::size_t i = 0; i < features_.size(); ++i) {
      look_at(i);
    }
    return allowed_mm;
  }
  visit_cells(box, [&](std::size_t cell) {
    for (const std::int32_t i : cells_[cell]) {
      look_at(static_cast<std::size_t>(i));
    }
  });
  return allowed_mm;
}

}  // namespace glint

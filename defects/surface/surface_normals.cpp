// SPDX-License-Identifier: GPL-3.0-or-later
//
// A normal belongs to a corner, not to a vertex: around each vertex the faces that are shaded as
// one surface form a fan, bounded by creases and by borders of exact surfaces; a fan on an exact
// surface takes its gradient, any other the mean of its faces by their angles at the vertex. Source
// of the weights: G. Thuermer and C. Wuethrich, "Computing vertex normals from polygonal facets",
// Journal of Graphics Tools 3(1), 1998. Cost: linear. docs/theory/imprint.md
#include "defects/surface/surface_normals.h"

#include <cmath>

#include <Eigen/Dense>

#include "core/error.h"
#include "defects/surface/half_edges.h"

namespace glint {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> face_normals(const TriangleMesh& mesh) {
  std::vector<Vector3d> normals(mesh.num_triangles());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    normals[i] = face_normal(mesh, i);
  }
  return normals;
}

/// Per half edge, whether the faces at both sides are shaded as one surface.
class SmoothEdges {
 public:
  SmoothEdges(const TriangleMesh& mesh, double crease_rad)
      : mesh_(mesh), opposite_(opposite_half_edges(mesh, VertexCorners(mesh))) {
    const std::vector<Vector3d> normals = face_normals(mesh);
    for (std::size_t i = 0; i < opposite_.size(); ++i) {
      const std::int32_t other = opposite_[i];
      if (other > static_cast<std::int32_t>(i) &&
          !is_smooth(normals, i / 3, at(other / 3), crease_rad)) {
        opposite_[i] = -1;
        opposite_[at(other)] = -1;
      }
    }
  }

  /// The corner of the same vertex in the next face, turning one way or the other; -1: none.
  std::int32_t forward(std::int32_t corner) const { return opposite_[at(previous_corner(corner))]; }

  std::int32_t backward(std::int32_t corner) const {
    const std::int32_t other = opposite_[at(corner)];
    return other < 0 ? -1 : next_corner(other);
  }

 private:
  bool is_smooth(const std::vector<Vector3d>& normals,
                 std::size_t a,
                 std::size_t b,
                 double crease_rad) const {
    if (mesh_.patch_of(a) != mesh_.patch_of(b)) {
      return false;
    }
    const Vector3d& n = normals[a];
    const Vector3d& m = normals[b];
    return mesh_.patch_of(a) >= 0 || std::atan2(n.cross(m).norm(), n.dot(m)) <= crease_rad;
  }

  const TriangleMesh& mesh_;
  std::vector<std::int32_t> opposite_;
};

/// The corners that are smoothed together with one, itself first.
void collect_fan(const SmoothEdges& edges, std::int32_t corner, std::vector<std::int32_t>& fan) {
  fan.assign(1, corner);
  std::int32_t other = edges.forward(corner);
  while (other >= 0 && other != corner) {
    fan.push_back(other);
    other = edges.forward(other);
  }
  if (other == corner) {
    return;
  }
  for (other = edges.backward(corner); other >= 0; other = edges.backward(other)) {
    fan.push_back(other);
  }
}

Vector3d fan_normal(const TriangleMesh& mesh,
                    std::span<const ExactPatch> patches,
                    const std::vector<std::int32_t>& fan) {
  const std::int32_t patch = mesh.patch_of(at(fan[0] / 3));
  if (patch >= 0) {
    const Vector3d& p = mesh.vertices_mm[at(origin_of(mesh, fan[0]))];
    if (const auto normal = exact_normal(patches[at(patch)], p)) {
      return *normal;
    }
  }
  Vector3d sum = Vector3d::Zero();
  for (const std::int32_t corner : fan) {
    sum += corner_angle_rad(mesh, corner) * face_normal(mesh, at(corner / 3));
  }
  const double length = sum.norm();
  return length > 0.0 ? Vector3d(sum / length) : Vector3d::UnitZ();
}

}  // namespace

void set_normals(TriangleMesh& mesh, std::span<const ExactPatch> patches, double crease_rad) {
  const SmoothEdges edges(mesh, crease_rad);
  mesh.normals.clear();
  mesh.corner_normals.assign(mesh.num_triangles(), {-1, -1, -1});
  std::vector<std::int32_t> fan;
  for (std::size_t i = 0; i < 3 * mesh.num_triangles(); ++i) {
    if (mesh.corner_normals[i / 3][i % 3] >= 0) {
      continue;
    }
    collect_fan(edges, static_cast<std::int32_t>(i), fan);
    for (const std::int32_t corner : fan) {
      mesh.corner_normals[at(corner / 3)][at(corner % 3)] =
          static_cast<std::int32_t>(mesh.normals.size());
    }
    mesh.normals.push_back(fan_normal(mesh, patches, fan));
  }
}

std::optional<Vector3d> exact_normal(const ExactPatch& patch, const Vector3d& p_mm) {
  Vector3d gradient = Vector3d::Zero();
  implicit_value(patch, p_mm, &gradient);
  const double length = gradient.norm();
  return length > 0.0 && std::isfinite(length) ? std::optional<Vector3d>(gradient / length)
                                               : std::nullopt;
}

namespace {

/// The smallest step that brings every F to zero to first order; largest_mm gets the largest |F|
/// before it.
Vector3d newton_step(std::span<const ExactPatch> patches,
                     std::span<const std::int32_t> patch_ids,
                     const Vector3d& p,
                     double& largest_mm) {
  const auto count = static_cast<Eigen::Index>(patch_ids.size());
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3> gradients(count, 3);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> values(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    Vector3d gradient = Vector3d::Zero();
    values[i] = implicit_value(patches[at(patch_ids[static_cast<std::size_t>(i)])], p, &gradient);
    gradients.row(i) = gradient.transpose();
  }
  largest_mm = values.cwiseAbs().maxCoeff();
  if (count == 1) {
    const Vector3d gradient = gradients.row(0).transpose();
    return -values[0] / gradient.squaredNorm() * gradient;
  }
  return gradients.completeOrthogonalDecomposition().solve(-values);
}

}  // namespace

Vector3d onto_patches(std::span<const ExactPatch> patches,
                      std::span<const std::int32_t> patch_ids,
                      const Vector3d& p_mm,
                      double max_move_mm) {
  if (patch_ids.empty() || patch_ids.size() > 3) {
    return p_mm;
  }
  Vector3d p = p_mm;
  constexpr int kMaxSteps = 12;
  for (int step = 0; step < kMaxSteps; ++step) {
    double largest_mm = 0.0;
    const Vector3d move = newton_step(patches, patch_ids, p, largest_mm);
    p += move;
    if (!((p - p_mm).norm() <= max_move_mm)) {  // also when it is not a number
      return p_mm;
    }
    constexpr double kConverged_mm = 1e-12;
    if (move.norm() <= kConverged_mm * std::max(1.0, 1e-2 * p.norm())) {
      constexpr double kOverlaps_mm = 1e-9;  // else surfaces that do not meet here
      return largest_mm <= kOverlaps_mm ? p : p_mm;
    }
  }
  return p_mm;
}

}  // namespace glint

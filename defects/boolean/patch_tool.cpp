// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/boolean/patch_tool.h"

#include <Eigen/Eigenvalues>

#include "defects/boolean/patch_probe.h"

namespace glint {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Rounding of a projection, and float boxes a little too small on top, are far below this part of
/// the coordinates.
constexpr double kSlack = 1e-6;

Matrix3d principal_axes(const std::vector<Vector3d>& points_mm) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points_mm) {
    mean += point;
  }
  mean /= static_cast<double>(points_mm.size());
  Matrix3d moments = Matrix3d::Zero();
  for (const Vector3d& point : points_mm) {
    moments += (point - mean) * (point - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(moments);
  return solver.eigenvectors().transpose();
}

}  // namespace

OrientedBox::OrientedBox(const std::vector<Vector3d>& points_mm)
    : axes_(principal_axes(points_mm)), abs_axes_(axes_.cwiseAbs()) {
  Vector3d low = Vector3d::Constant(1e300);
  Vector3d high = -low;
  for (const Vector3d& point : points_mm) {
    const Vector3d along = axes_ * point;
    low = low.cwiseMin(along);
    high = high.cwiseMax(along);
    bounds_.add(box_of(point, point, point));
  }
  centre_mm_ = 0.5 * (low + high);
  half_size_mm_ = 0.5 * (high - low);
  const double reach = centre_mm_.cwiseAbs().maxCoeff() + half_size_mm_.maxCoeff();
  half_size_mm_.array() += kSlack * reach;
}

bool OrientedBox::may_intersect(const FloatBox& box) const {
  if (!box.overlaps(bounds_)) {
    return false;
  }
  const Vector3d low(static_cast<double>(box.min_mm[0]),
                     static_cast<double>(box.min_mm[1]),
                     static_cast<double>(box.min_mm[2]));
  const Vector3d high(static_cast<double>(box.max_mm[0]),
                      static_cast<double>(box.max_mm[1]),
                      static_cast<double>(box.max_mm[2]));
  const Vector3d distance = (axes_ * (0.5 * (low + high)) - centre_mm_).cwiseAbs();
  const Vector3d reach = abs_axes_ * (0.5 * (high - low)) + half_size_mm_;
  return (distance.array() <= reach.array()).all();
}

bool OrientedBox::may_intersect(const Corners& corners) const {
  const Vector3d a = axes_ * corners[0] - centre_mm_;
  const Vector3d b = axes_ * corners[1] - centre_mm_;
  const Vector3d c = axes_ * corners[2] - centre_mm_;
  const Vector3d low = a.cwiseMin(b).cwiseMin(c);
  const Vector3d high = a.cwiseMax(b).cwiseMax(c);
  return (low.array() <= half_size_mm_.array()).all() &&
         (high.array() >= -half_size_mm_.array()).all();
}

bool OrientedBox::is_outside(const Vector3d& point) const {
  return ((axes_ * point - centre_mm_).cwiseAbs().array() > half_size_mm_.array()).any();
}

PatchTool::PatchTool(const TriangleMesh& mesh)
    : triangles(mesh.triangles),
      vertices_mm(mesh.vertices_mm),
      edges(match_edges(mesh.triangles)),
      box(mesh.vertices_mm) {
  std::vector<FloatBox> boxes;
  faces.reserve(triangles.size());
  boxes.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    faces.emplace_back(triangles[i],
                       Corners{mesh.vertex(i, 0), mesh.vertex(i, 1), mesh.vertex(i, 2)});
    boxes.push_back(faces.back().box());
  }
  tree = BoxTree(boxes);
}

bool PatchTool::contains(const Vector3d& point) const {
  if (box.is_outside(point)) {
    return false;
  }
  return is_inside_surface(point, [&](const Probe& probe) {
    int hits = 0;
    tree.visit_if([&](const FloatBox& bounds) { return probe.may_intersect(bounds); },
                  [&](std::int32_t face) {
                    hits += probe.hits(faces[static_cast<std::size_t>(face)].corners) ? 1 : 0;
                  });
    return hits;
  });
}

}  // namespace glint

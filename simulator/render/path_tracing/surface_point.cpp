// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a hit of a triangle to the surface that it stands for: the ray is polished onto the exact
// surface where the part has one, heights tilt the normal, and the frame follows the lay of the
// material. Rays leave from just above the plane of the triangle, lifted so far that the triangle
// cannot shade its own point. Cost: a few Newton steps a hit. docs/theory/path_tracing.md, "Where
// rays start".
#include "simulator/render/path_tracing/surface_point.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

using Eigen::Vector3d;

/// A hit on the exact surface further than this from the triangle's is not believed.
constexpr double kMaxPolishMove_mm = 1.0;

/// Point and normal of the surface without detail.
struct SmoothPoint {
  Vector3d point_mm;
  Vector3d normal;  ///< outward
  bool is_exact = false;
};

Vector3d plane_normal(const PhysicalScene& scene,
                      std::int32_t triangle,
                      const Vector3d& else_this) {
  const TrianglePlane& plane = scene.bvh.plane(triangle);
  const Vector3d normal(plane.normal_x, plane.normal_y, plane.normal_z);
  return normal.squaredNorm() > 0.5 ? normal : else_this;
}

SmoothPoint smooth_point(const PhysicalScene& scene,
                         const Ray& ray,
                         const Hit& hit,
                         const Vector3d& of_plane) {
  const TriangleMesh& mesh = scene.part.mesh;
  const Vector3d point_mm = hit_point(mesh, hit);
  const std::int32_t patch = mesh.patch_of(static_cast<std::size_t>(hit.triangle));
  if (patch >= 0) {
    const auto exact = polish(scene.part.patches[static_cast<std::size_t>(patch)],
                              ray,
                              static_cast<double>(hit.t_mm),
                              kMaxPolishMove_mm);
    if (exact && exact->normal.dot(of_plane) > 0.0) {
      return {.point_mm = exact->point_mm, .normal = exact->normal, .is_exact = true};
    }
  }
  const Vector3d normal = mesh.corner_normals.empty() ? of_plane : shading_normal(mesh, hit);
  return {.point_mm = point_mm, .normal = normal.dot(of_plane) > 0.0 ? normal : of_plane};
}

/// A normal the viewer can see: bent towards them where interpolation or detail turned it away.
Vector3d seen_normal(const Vector3d& normal, const Vector3d& to_viewer) {
  constexpr double kMinCosine = 1e-4;
  const double cosine = normal.dot(to_viewer);
  return cosine >= kMinCosine ? normal
                              : Vector3d((normal + (kMinCosine - cosine) * to_viewer).normalized());
}

/// The tangent field and its frame are the part's, which its pose has moved.
ShadingFrame frame_in_scene(const PhysicalScene& scene,
                            const Vector3d& point_mm,
                            const Vector3d& normal) {
  const RigidTransform& pose = scene.part.scene_from_part;
  const ShadingFrame frame =
      scene.material.frame_at(pose.rotation.transpose() * (point_mm - pose.translation_mm),
                              pose.rotation.transpose() * normal);
  return {.tangent = pose.rotation * frame.tangent,
          .bitangent = pose.rotation * frame.bitangent,
          .normal = pose.rotation * frame.normal};
}

/// Applies heights and stains. @param outside  1, or -1 where the inside of the part is seen
/// @return the normal on the viewer's side
Vector3d apply_detail(const PhysicalScene& scene,
                      const Ray& ray,
                      const SmoothPoint& smooth,
                      double outside,
                      ShadingPoint& point) {
  const Vector3d normal = outside * smooth.normal;
  if (scene.detail.empty()) {
    return normal;
  }
  const SurfaceDetail::Sample sample = scene.detail.sample(smooth.point_mm, smooth.normal);
  point.point_mm += sample.moved_height_mm * smooth.normal;
  point.reflectance = sample.reflectance;
  if (sample.feature >= 0 && sample.normalised_distance <= 1.0) {
    point.defect = sample.feature;
  }
  return ray.direction.dot(normal) < 0.0
             ? detailed_normal(normal, outside * sample.gradient, ray.direction)
             : normal;
}

}  // namespace

double start_offset_mm(const Part& part) {
  constexpr double kShare = 2e-6;
  double largest_mm = 1e-3;
  for (const Vector3d& vertex : part.mesh.vertices_mm) {
    largest_mm = std::max(largest_mm, vertex.cwiseAbs().maxCoeff());
  }
  return kShare * largest_mm;
}

ShadingPoint intersect_surface(const PhysicalScene& scene,
                               double start_offset_mm,
                               const Ray& ray,
                               const Hit& hit) {
  const Vector3d to_viewer = -ray.direction;
  const Vector3d of_plane = plane_normal(scene, hit.triangle, to_viewer);
  const double outside = of_plane.dot(to_viewer) >= 0.0 ? 1.0 : -1.0;
  const SmoothPoint smooth = smooth_point(scene, ray, hit, of_plane);
  ShadingPoint point;
  point.point_mm = smooth.point_mm;
  if (!scene.face_labels.empty()) {
    const std::int32_t label = scene.face_labels[static_cast<std::size_t>(hit.triangle)];
    point.defect = label > 0 ? label : -1;
  }
  const Vector3d detailed = apply_detail(scene, ray, smooth, outside, point);
  point.side = outside * (smooth.is_exact ? smooth.normal : of_plane);
  const Vector3d up = outside * of_plane;
  const double below_mm = up.dot(hit_point(scene.part.mesh, hit) - point.point_mm);
  point.start_mm = point.point_mm + (std::max(0.0, below_mm) + start_offset_mm) * up;
  point.frame = frame_in_scene(scene, point.point_mm, seen_normal(detailed, to_viewer));
  point.to_viewer = point.frame.to_local(to_viewer);
  return point;
}

}  // namespace glint

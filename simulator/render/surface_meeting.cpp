// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/surface_meeting.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <Eigen/Geometry>

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Reflected rays start this far off the triangle, against hits on the triangle itself. It only
/// decides whether the part is met again; the kept origin is the exact point.
constexpr double kStartOffset_mm = 1e-3;

/// A hit on the exact surface further than this from the triangle's is not believed.
constexpr double kMaxPolishMove_mm = 1.0;

Vector3d direction_of(const CameraPacket& rays, std::size_t lane) {
  return {rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]};
}

void set_point(MeetingLanes& lanes, std::size_t lane, const Vector3d& p, const Vector3d& normal) {
  lanes.point_x[lane] = p.x();
  lanes.point_y[lane] = p.y();
  lanes.point_z[lane] = p.z();
  lanes.normal_x[lane] = normal.x();
  lanes.normal_y[lane] = normal.y();
  lanes.normal_z[lane] = normal.z();
}

/// The planes of the triangles that were hit; lanes without a hit get one across the ray.
void gather_planes(const Bvh& bvh,
                   const CameraPacket& rays,
                   const HitPacket& hits,
                   MeetingLanes& lanes) {
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    lanes.direction_x[lane] = rays.direction_x[lane];
    lanes.direction_y[lane] = rays.direction_y[lane];
    lanes.direction_z[lane] = rays.direction_z[lane];
    const TrianglePlane plane = hits.triangle[lane] >= 0
                                    ? bvh.plane(hits.triangle[lane])
                                    : TrianglePlane{.normal_x = -rays.direction_x[lane],
                                                    .normal_y = -rays.direction_y[lane],
                                                    .normal_z = -rays.direction_z[lane]};
    lanes.face_x[lane] = plane.normal_x;
    lanes.face_y[lane] = plane.normal_y;
    lanes.face_z[lane] = plane.normal_z;
    lanes.offset_mm[lane] = plane.offset_mm;
  }
}

/// Rays almost along a plane do not tell well where they cut it: there the hit does.
void mend_flat_hits(const TriangleMesh& mesh,
                    const CameraPacket& rays,
                    const HitPacket& hits,
                    MeetingLanes& lanes) {
  constexpr double kFlat = 1e-2;
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    if (hits.triangle[lane] >= 0 && !(std::abs(lanes.slope[lane]) > kFlat)) {
      lanes.t_mm[lane] =
          (hit_point(mesh, hit_of(hits, lane)) - rays.origin_mm).dot(direction_of(rays, lane));
    }
  }
}

/// Barycentrics of a point of a triangle's plane.
Vector2d barycentrics(const TriangleMesh& mesh, std::size_t triangle, const Vector3d& p_mm) {
  const Vector3d& origin_mm = mesh.vertex(triangle, 0);
  const Vector3d e1 = mesh.vertex(triangle, 1) - origin_mm;
  const Vector3d e2 = mesh.vertex(triangle, 2) - origin_mm;
  const Vector3d p = p_mm - origin_mm;
  const double determinant = e1.squaredNorm() * e2.squaredNorm() - e1.dot(e2) * e1.dot(e2);
  return Vector2d(e2.squaredNorm() * p.dot(e1) - e1.dot(e2) * p.dot(e2),
                  e1.squaredNorm() * p.dot(e2) - e1.dot(e2) * p.dot(e1)) /
         determinant;
}

/// A lane whose surface has no kernel or is not believed: an involute, or the triangle itself.
void meet_scalar(const TraceScene& scene,
                 const CameraPacket& rays,
                 const Hit& hit,
                 bool holds_triangles,
                 std::size_t lane,
                 MeetingLanes& lanes) {
  const TriangleMesh& mesh = scene.part.mesh;
  const auto triangle = static_cast<std::size_t>(hit.triangle);
  const std::int32_t patch = mesh.patch_of(triangle);
  const Vector3d direction = direction_of(rays, lane);
  const bool is_scalar = patch >= 0 && scene.patches[static_cast<std::size_t>(patch)].kind ==
                                           PatchCoefficients::Kind::kNone;
  if (is_scalar) {
    const auto exact = polish(scene.part.patches[static_cast<std::size_t>(patch)],
                              {.origin_mm = rays.origin_mm, .direction = direction},
                              lanes.t_mm[lane],
                              kMaxPolishMove_mm);
    if (exact) {
      set_point(lanes, lane, exact->point_mm, exact->normal);
      return;
    }
  }
  if (!holds_triangles) {
    set_point(lanes, lane, hit_point(mesh, hit), shading_normal(mesh, hit));
    return;
  }
  const Vector3d p_mm = rays.origin_mm + lanes.t_mm[lane] * direction;
  const Vector2d uv = barycentrics(mesh, triangle, p_mm);
  const Vector3d normal = (1.0 - uv.x() - uv.y()) * mesh.normal(triangle, 0) +
                          uv.x() * mesh.normal(triangle, 1) + uv.y() * mesh.normal(triangle, 2);
  set_point(lanes, lane, p_mm, normal.normalized());
}

/// Polishes all lanes as if they met one patch.
void polish_lanes(const TraceScene& scene,
                  const CameraPacket& rays,
                  std::int32_t patch,
                  const MeetingLanes& from,
                  MeetingLanes& to,
                  Lanes& is_found) {
  polish16(scene.patches[static_cast<std::size_t>(patch)],
           rays.origin_mm.data(),
           kMaxPolishMove_mm,
           {.direction_x = from.direction_x,
            .direction_y = from.direction_y,
            .direction_z = from.direction_z,
            .start_t_mm = from.t_mm,
            .point_x = to.point_x,
            .point_y = to.point_y,
            .point_z = to.point_z,
            .normal_x = to.normal_x,
            .normal_y = to.normal_y,
            .normal_z = to.normal_z,
            .is_found = is_found.data()});
}

/// Packets across several patches: a kernel for each of them.
void polish_patches(const TraceScene& scene,
                    const CameraPacket& rays,
                    const std::array<std::int32_t, kPacketSize>& patch,
                    MeetingLanes& lanes,
                    Lanes& is_found) {
  MeetingLanes one;
  std::array<bool, kPacketSize> is_tried = {};
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    const std::int32_t which = patch[lane];
    if (which < 0 || is_tried[lane] ||
        scene.patches[static_cast<std::size_t>(which)].kind == PatchCoefficients::Kind::kNone) {
      continue;
    }
    alignas(64) Lanes is_one;
    polish_lanes(scene, rays, which, lanes, one, is_one);
    for (std::size_t k = lane; k < kPacketSize; ++k) {
      if (patch[k] == which) {
        is_tried[k] = true;
        is_found[k] = is_one[k];
        set_point(lanes,
                  k,
                  {one.point_x[k], one.point_y[k], one.point_z[k]},
                  {one.normal_x[k], one.normal_y[k], one.normal_z[k]});
      }
    }
  }
}

/// Points and normals of all lanes: kernels for the patches among them, the rest one by one.
void meet_surface(const TraceScene& scene,
                  const CameraPacket& rays,
                  const HitPacket& hits,
                  bool holds_triangles,
                  MeetingLanes& lanes) {
  std::array<std::int32_t, kPacketSize> patch;
  bool is_one = true;
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    const std::int32_t triangle = hits.triangle[lane];
    patch[lane] = triangle < 0 ? -1 : scene.part.mesh.patch_of(static_cast<std::size_t>(triangle));
    is_one = is_one && patch[lane] == patch[0];
  }
  alignas(64) Lanes is_found = {};
  if (is_one && patch[0] >= 0 &&
      scene.patches[static_cast<std::size_t>(patch[0])].kind != PatchCoefficients::Kind::kNone) {
    polish_lanes(scene, rays, patch[0], lanes, lanes, is_found);
  } else {
    polish_patches(scene, rays, patch, lanes, is_found);
  }
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    if (hits.triangle[lane] < 0) {
      set_point(lanes, lane, Vector3d::Zero(), -direction_of(rays, lane));
    } else if (is_found[lane] == 0.0) {
      meet_scalar(scene, rays, hit_of(hits, lane), holds_triangles, lane, lanes);
    }
  }
}

/// {min, max} of everything that a feature can reach, wherever the surface lies.
std::array<double, 6> box_of(const HeightFeature& feature) {
  const double reach_mm = SurfaceDetail::kReachRadii * 2.0 * feature.cross_sigma_mm();
  const double half_mm = std::sqrt(3.0) * (feature.half_line_mm() + reach_mm);
  const Vector3d& c = feature.centre_mm;
  return {c.x() - half_mm,
          c.y() - half_mm,
          c.z() - half_mm,
          c.x() + half_mm,
          c.y() + half_mm,
          c.z() + half_mm};
}

/// False when all points of a packet are out of reach of all features.
bool is_near_detail(const TraceScene& scene, const MeetingLanes& lanes) {
  return scene.feature_boxes.empty() ||
         std::ranges::any_of(scene.feature_boxes, [&](const std::array<double, 6>& box) {
           return is_any_inside16(lanes.point_x, lanes.point_y, lanes.point_z, box.data());
         });
}

void add_detail(const SurfaceDetail& detail, const HitPacket& hits, MeetingLanes& lanes) {
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    if (hits.triangle[lane] < 0) {
      continue;
    }
    const Vector3d p(lanes.point_x[lane], lanes.point_y[lane], lanes.point_z[lane]);
    const Vector3d normal(lanes.normal_x[lane], lanes.normal_y[lane], lanes.normal_z[lane]);
    const SurfaceDetail::Sample sample = detail.sample(p, normal);
    if (sample.feature >= 0) {
      const Vector3d direction(
          lanes.direction_x[lane], lanes.direction_y[lane], lanes.direction_z[lane]);
      const double slant = direction.dot(normal);
      set_point(lanes,
                lane,
                p + direction * (sample.moved_height_mm / slant),
                detailed_normal(normal, sample.gradient, direction));
    }
  }
}

}  // namespace

Hit hit_of(const HitPacket& hits, std::size_t lane) {
  return {.t_mm = hits.t_mm[lane],
          .triangle = hits.triangle[lane],
          .u = hits.u[lane],
          .v = hits.v[lane]};
}

Interaction interact(const TraceScene& scene, const Ray& ray, const Hit& hit) {
  Interaction at;
  const TriangleMesh& mesh = scene.part.mesh;
  const Vector3d on_triangle = hit_point(mesh, hit);
  at.point_mm = on_triangle;
  at.geometric_normal = geometric_normal(mesh, hit);
  Vector3d normal;
  const std::int32_t patch = mesh.patch_of(static_cast<std::size_t>(hit.triangle));
  std::optional<SurfaceHit> exact;
  if (patch >= 0) {
    exact = polish(scene.part.patches[static_cast<std::size_t>(patch)],
                   ray,
                   (on_triangle - ray.origin_mm).dot(ray.direction),
                   kMaxPolishMove_mm);
  }
  if (exact) {
    at.point_mm = exact->point_mm;
    normal = exact->normal;
  } else {
    normal = shading_normal(mesh, hit);
  }
  if (at.geometric_normal.dot(ray.direction) > 0.0) {  // an open sheet seen from behind
    at.geometric_normal = -at.geometric_normal;
    normal = -normal;
  }
  if (normal.dot(ray.direction) >= 0.0) {  // a smoothed normal turned away at a silhouette
    normal = at.geometric_normal;
  }
  if (!scene.detail.empty()) {
    const SurfaceDetail::Sample sample = scene.detail.sample(at.point_mm, normal);
    if (sample.feature >= 0) {
      const double slant = ray.direction.dot(normal);
      at.point_mm += ray.direction * (sample.moved_height_mm / slant);
      normal = detailed_normal(normal, sample.gradient, ray.direction);
    }
  }
  at.direction = (ray.direction - 2.0 * ray.direction.dot(normal) * normal).normalized();
  at.start_mm = on_triangle + kStartOffset_mm * at.geometric_normal;
  return at;
}

TraceScene::TraceScene(const Part& traced_part,
                       const Bvh& traced_bvh,
                       const SurfaceDetail& traced_detail,
                       const RenderSettings& render_settings)
    : part(traced_part), bvh(traced_bvh), detail(traced_detail), settings(render_settings) {
  std::ranges::transform(part.patches, std::back_inserter(patches), coefficients_of);
  constexpr std::size_t kMaxBoxes = 32;
  if (detail.features().size() <= kMaxBoxes) {
    std::ranges::transform(detail.features(), std::back_inserter(feature_boxes), box_of);
  }
}

void meet_part(const TraceScene& scene,
               const CameraPacket& rays,
               const HitPacket& hits,
               bool holds_triangles,
               MeetingLanes& lanes) {
  gather_planes(scene.bvh, rays, hits, lanes);
  meet_planes16(rays.origin_mm.data(), lanes);
  if (!holds_triangles) {
    mend_flat_hits(scene.part.mesh, rays, hits, lanes);
  }
  meet_surface(scene, rays, hits, holds_triangles, lanes);
  orient16(lanes);
  if (!scene.detail.empty() && is_near_detail(scene, lanes)) {
    add_detail(scene.detail, hits, lanes);
  }
  reflect16(rays.origin_mm.data(), kStartOffset_mm, lanes);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where sixteen rays meet the part, and how they leave it. The hit in float is computed again in
// double: on the plane of its triangle, then moved onto the exact surface that the triangle stands
// for (exact_kernels.h), and its normal tilted by the gradient of height features nearby. When all
// rays of a packet meet the same triangle or surface, one loop over the lanes serves them all.
// docs/theory/parts.md and tunnel.md. Cost: constant per ray, more within reach of height features;
// no memory beyond the packet.
#include "simulator/render/ray_cache/surface_intersection.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

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

Hit hit_of(const HitPacket& hits, std::size_t lane) {
  return {.t_mm = hits.t_mm[lane],
          .triangle = hits.triangle[lane],
          .u = hits.u[lane],
          .v = hits.v[lane]};
}

Vector3d origin_of(const IntersectionLanes& lanes, std::size_t lane) {
  return {lanes.origin_x[lane], lanes.origin_y[lane], lanes.origin_z[lane]};
}

Vector3d direction_of(const IntersectionLanes& lanes, std::size_t lane) {
  return {lanes.direction_x[lane], lanes.direction_y[lane], lanes.direction_z[lane]};
}

void set_point(IntersectionLanes& lanes,
               std::size_t lane,
               const Vector3d& p,
               const Vector3d& normal) {
  lanes.point_x[lane] = p.x();
  lanes.point_y[lane] = p.y();
  lanes.point_z[lane] = p.z();
  lanes.normal_x[lane] = normal.x();
  lanes.normal_y[lane] = normal.y();
  lanes.normal_z[lane] = normal.z();
}

/// The planes of the triangles that were hit; lanes without a hit get one across the ray.
/// @param common  the triangle that all lanes hit, or -1
void gather_planes(const Bvh& bvh,
                   const HitPacket& hits,
                   std::int32_t common,
                   IntersectionLanes& lanes) {
  if (common >= 0) {
    const TrianglePlane& plane = bvh.plane(common);
    set_plane16(plane.normal_x, plane.normal_y, plane.normal_z, plane.offset_mm, lanes);
    return;
  }
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    const TrianglePlane plane = hits.triangle[lane] >= 0
                                    ? bvh.plane(hits.triangle[lane])
                                    : TrianglePlane{.normal_x = -lanes.direction_x[lane],
                                                    .normal_y = -lanes.direction_y[lane],
                                                    .normal_z = -lanes.direction_z[lane]};
    lanes.face_x[lane] = plane.normal_x;
    lanes.face_y[lane] = plane.normal_y;
    lanes.face_z[lane] = plane.normal_z;
    lanes.offset_mm[lane] = plane.offset_mm;
  }
}

constexpr double kFlat = 1e-2;

/// Rays almost along a plane do not tell well where they cut it: there the hit does.
void mend_flat_hits(const TriangleMesh& mesh, const HitPacket& hits, IntersectionLanes& lanes) {
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    if (hits.triangle[lane] >= 0 && !(std::abs(lanes.slope[lane]) > kFlat)) {
      lanes.t_mm[lane] = (hit_point(mesh, hit_of(hits, lane)) - origin_of(lanes, lane))
                             .dot(direction_of(lanes, lane));
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

void set_lane(const TriangleMesh& mesh,
              std::size_t triangle,
              const Vector2d& uv,
              std::size_t lane,
              ShadeLanes& shade) {
  shade.is_wanted[lane] = 1.0;
  shade.u[lane] = uv.x();
  shade.v[lane] = uv.y();
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const Vector3d& normal = mesh.normal(triangle, corner);
    shade.normal_x[corner][lane] = normal.x();
    shade.normal_y[corner][lane] = normal.y();
    shade.normal_z[corner][lane] = normal.z();
  }
}

/// Lanes on triangles themselves, or whose exact surface is not believed.
void intersect_triangles(const TriangleMesh& mesh,
                         const HitPacket& hits,
                         bool keeps_triangles,
                         const Lanes& is_found,
                         IntersectionLanes& lanes) {
  ShadeLanes shade = {};
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    if (hits.triangle[lane] < 0 || is_found[lane] != 0.0) {
      continue;
    }
    const auto triangle = static_cast<std::size_t>(hits.triangle[lane]);
    Vector2d uv(static_cast<double>(hits.u[lane]), static_cast<double>(hits.v[lane]));
    if (keeps_triangles) {
      uv = barycentrics(
          mesh, triangle, origin_of(lanes, lane) + lanes.t_mm[lane] * direction_of(lanes, lane));
    }
    set_lane(mesh, triangle, uv, lane, shade);
  }
  shade16(shade, lanes);
}

/// Polishes all lanes as if they met one patch.
void polish_lanes(const PatchCoefficients& patch,
                  const IntersectionLanes& from,
                  IntersectionLanes& to,
                  Lanes& is_found) {
  polish16(patch,
           kMaxPolishMove_mm,
           {.origin_x = from.origin_x,
            .origin_y = from.origin_y,
            .origin_z = from.origin_z,
            .direction_x = from.direction_x,
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
void polish_patches(const TraceScene& scene, IntersectionLanes& lanes, Lanes& is_found) {
  IntersectionLanes one;
  std::array<bool, kPacketSize> is_tried = {};
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    const std::int32_t which = lanes.patch[lane];
    if (which < 0 || is_tried[lane]) {
      continue;
    }
    alignas(64) Lanes is_one;
    polish_lanes(scene.patches[static_cast<std::size_t>(which)], lanes, one, is_one);
    for (std::size_t k = lane; k < kPacketSize; ++k) {
      if (lanes.patch[k] == which) {
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

/// The exact surfaces that lanes meet.
struct HitPatches {
  std::int32_t lowest = -1;  ///< of lanes with a hit; -1: a triangle without an exact surface
  std::int32_t highest = -1;
  bool has_missed = false;
};

/// Sets lanes.patch. @param common  the triangle that all lanes hit, or -1
HitPatches gather_patches(const TriangleMesh& mesh,
                          const HitPacket& hits,
                          std::int32_t common,
                          IntersectionLanes& lanes) {
  if (common >= 0) {
    const std::int32_t patch = mesh.patch_of(static_cast<std::size_t>(common));
    std::ranges::fill(lanes.patch, patch);
    return {.lowest = patch, .highest = patch};
  }
  HitPatches met = {.lowest = std::numeric_limits<std::int32_t>::max()};
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    const std::int32_t triangle = hits.triangle[lane];
    const std::int32_t patch =
        triangle < 0 ? -1 : mesh.patch_of(static_cast<std::size_t>(triangle));
    lanes.patch[lane] = patch;
    met.lowest = triangle < 0 ? met.lowest : std::min(met.lowest, patch);
    met.highest = std::max(met.highest, patch);
    met.has_missed = met.has_missed || triangle < 0;
  }
  return met;
}

/// Points and normals of all lanes: by the exact surfaces among them, the rest by triangles.
void intersect_surface(const TraceScene& scene,
                       const HitPacket& hits,
                       std::int32_t common,
                       bool keeps_triangles,
                       IntersectionLanes& lanes) {
  const TriangleMesh& mesh = scene.part.mesh;
  const HitPatches met = gather_patches(mesh, hits, common, lanes);
  alignas(64) Lanes is_found = {};
  if (met.highest >= 0 && met.lowest == met.highest) {
    polish_lanes(scene.patches[static_cast<std::size_t>(met.highest)], lanes, lanes, is_found);
  } else if (met.highest >= 0) {
    polish_patches(scene, lanes, is_found);
  }
  for (std::size_t lane = 0; met.has_missed && lane < kPacketSize; ++lane) {
    if (hits.triangle[lane] < 0) {
      set_point(lanes, lane, Vector3d::Zero(), -direction_of(lanes, lane));
    }
  }
  if (is_any_unfound16(hits.triangle.data(), is_found.data())) {
    intersect_triangles(mesh, hits, keeps_triangles, is_found, lanes);
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

/// Wider than the mesh by more than Bvh moves rays that miss, and than its rounding.
std::array<double, 6> box_around(const TriangleMesh& mesh) {
  constexpr double kMargin = 1e-2;
  const BoundingBox box = bounding_box(mesh);
  const double margin_mm = kMargin * (1.0 + box.size_mm().norm());
  const Vector3d low = box.min_mm.array() - margin_mm;
  const Vector3d high = box.max_mm.array() + margin_mm;
  return {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()};
}

/// False when all points of a packet are out of reach of all features.
bool is_near_detail(const TraceScene& scene, const IntersectionLanes& lanes) {
  return scene.feature_boxes.empty() ||
         std::ranges::any_of(scene.feature_boxes, [&](const std::array<double, 6>& box) {
           return is_any_inside16(lanes.point_x, lanes.point_y, lanes.point_z, box.data());
         });
}

void add_detail(const SurfaceDetail& detail,
                const HitPacket& hits,
                SurfaceDetail::Relief relief,
                IntersectionLanes& lanes) {
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    if (hits.triangle[lane] < 0) {
      continue;
    }
    const Vector3d p(lanes.point_x[lane], lanes.point_y[lane], lanes.point_z[lane]);
    const Vector3d normal(lanes.normal_x[lane], lanes.normal_y[lane], lanes.normal_z[lane]);
    const SurfaceDetail::Sample sample = detail.sample(p, normal, relief);
    if (sample.feature >= 0) {
      const Vector3d direction = direction_of(lanes, lane);
      lanes.reflectance[lane] = sample.reflectance;
      const double slant = direction.dot(normal);
      set_point(lanes,
                lane,
                p + direction * (sample.moved_height_mm / slant),
                detailed_normal(normal, sample.gradient, direction));
    }
  }
}

/// What rays meet whose origins and directions are set, and how they leave.
void intersect(const TraceScene& scene,
               const HitPacket& hits,
               bool keeps_triangles,
               IntersectionLanes& lanes) {
  const std::int32_t common = common_triangle16(hits);
  gather_planes(scene.bvh, hits, common, lanes);
  const bool has_flat = intersect_planes16(kFlat, lanes);
  if (has_flat && !keeps_triangles) {
    mend_flat_hits(scene.part.mesh, hits, lanes);
  }
  intersect_surface(scene, hits, common, keeps_triangles, lanes);
  orient16(lanes);
  if (!scene.detail.empty() && is_near_detail(scene, lanes)) {
    add_detail(scene.detail,
               hits,
               keeps_triangles ? SurfaceDetail::Relief::kWithout : SurfaceDetail::Relief::kWith,
               lanes);
  }
  reflect16(kStartOffset_mm, lanes);
}

}  // namespace

TraceScene::TraceScene(const Part& traced_part,
                       const Bvh& traced_bvh,
                       const SurfaceDetail& traced_detail,
                       const RenderSettings& render_settings)
    : part(traced_part), bvh(traced_bvh), detail(traced_detail), settings(render_settings) {
  std::ranges::transform(part.patches, std::back_inserter(patches), coefficients_of);
  box = box_around(part.mesh);
  if (!bvh.is_convex()) {
    escape_cone = &bvh.escape_cone(part.mesh);
  }
  constexpr std::size_t kMaxBoxes = 32;
  if (detail.features().size() <= kMaxBoxes) {
    std::ranges::transform(detail.features(), std::back_inserter(feature_boxes), box_of);
  }
}

void intersect_part(const TraceScene& scene,
                    const CameraPacket& rays,
                    const HitPacket& hits,
                    bool keeps_triangles,
                    IntersectionLanes& lanes) {
  arrive16(rays.origin_mm.data(),
           rays.direction_x.data(),
           rays.direction_y.data(),
           rays.direction_z.data(),
           lanes);
  intersect(scene, hits, keeps_triangles, lanes);
}

void intersect_again(const TraceScene& scene,
                     const IntersectionLanes& before,
                     const HitPacket& hits,
                     IntersectionLanes& lanes) {
  follow16(before, lanes);
  intersect(scene, hits, false, lanes);
}

}  // namespace glint

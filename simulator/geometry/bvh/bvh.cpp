// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bounding volume hierarchy is Embree's (Wald et al., "Embree: a kernel framework for efficient
// CPU ray tracing", ACM TOG 33, 2014) in its robust mode, traversed sixteen rays at a time. What is
// added is what float numbers miss: rays that aim exactly at a vertex are tried again a little
// aside, and positions are left to whoever has the exact surface. Cost of a ray: that of Embree and
// of the copies into its packets. docs/theory/tunnel.md, "What is kept".
#include "simulator/geometry/bvh/bvh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <mutex>
#include <utility>

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include "core/error.h"
#include "core/index.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Owns an Embree device or scene.
struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};

struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

struct GeometryRelease {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};

using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceRelease>;
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneRelease>;
using Geometry = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, GeometryRelease>;

void throw_on_error(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) {
    throw std::bad_alloc();
  }
  if (error != RTC_ERROR_NONE) {
    throw Error(
        fmt::format("the ray tracer failed with Embree's error {}", static_cast<int>(error)));
  }
}

/// No thread count here: Embree would limit oneTBB for the whole program to it.
Device make_device() {
  Device device(rtcNewDevice("set_affinity=0"));
  if (!device) {
    throw_on_error(nullptr);
    throw Error("the ray tracer cannot be started");
  }
  return device;
}

void fill_buffers(RTCGeometry geometry, const TriangleMesh& mesh) {
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry,
                                                               RTC_BUFFER_TYPE_VERTEX,
                                                               0,
                                                               RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float),
                                                               mesh.vertices_mm.size()));
  auto* triangles = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry,
                                                                        RTC_BUFFER_TYPE_INDEX,
                                                                        0,
                                                                        RTC_FORMAT_UINT3,
                                                                        3 * sizeof(std::uint32_t),
                                                                        mesh.num_triangles()));
  if (vertices == nullptr || triangles == nullptr) {
    return;  // the device holds the error
  }
  for (const Vector3d& vertex : mesh.vertices_mm) {
    vertices = std::copy_n(vertex.cast<float>().eval().data(), 3, vertices);
  }
  for (const Triangle& triangle : mesh.triangles) {
    triangles = std::ranges::transform(triangle, triangles, [](std::int32_t i) {
                  return static_cast<std::uint32_t>(i);
                }).out;
  }
}

RTCRay single_ray(const Vector3d& origin_mm,
                  const Vector3d& direction,
                  double t_min_mm,
                  double t_max_mm) {
  RTCRay ray = {};
  ray.org_x = static_cast<float>(origin_mm.x());
  ray.org_y = static_cast<float>(origin_mm.y());
  ray.org_z = static_cast<float>(origin_mm.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = static_cast<float>(t_min_mm);
  ray.tfar = static_cast<float>(t_max_mm);
  ray.mask = ~0U;
  return ray;
}

/// Embree's robust mode closes edges, but lets about 1 % of the rays through that aim exactly at a
/// vertex (measured on a sphere of 117,000 triangles). Rays that miss are tried once more a
/// millionth of a radian aside.
constexpr std::array<double, 3> kNudge = {0.61e-6, 0.37e-6, 0.53e-6};

/// Of a size that is known, so that no function is called.
void copy16(const std::array<float, kPacketSize>& from, float* to) {
  std::memcpy(to, from.data(), sizeof(from));
}

static_assert(offsetof(RayQuery, origin_x) == offsetof(RTCRayHit16, ray.org_x));
static_assert(offsetof(RayQuery, t_min) == offsetof(RTCRayHit16, ray.tnear));
static_assert(offsetof(RayQuery, direction_x) == offsetof(RTCRayHit16, ray.dir_x));
static_assert(offsetof(RayQuery, time) == offsetof(RTCRayHit16, ray.time));
static_assert(offsetof(RayQuery, t_max) == offsetof(RTCRayHit16, ray.tfar));
static_assert(offsetof(RayQuery, mask) == offsetof(RTCRayHit16, ray.mask));
static_assert(offsetof(RayQuery, flags) == offsetof(RTCRayHit16, ray.flags));
static_assert(offsetof(RayQuery, normal_x) == offsetof(RTCRayHit16, hit.Ng_x));
static_assert(offsetof(RayQuery, u) == offsetof(RTCRayHit16, hit.u));
static_assert(offsetof(RayQuery, triangle) == offsetof(RTCRayHit16, hit.primID));
static_assert(offsetof(RayQuery, geometry) == offsetof(RTCRayHit16, hit.geomID));
static_assert(offsetof(RayQuery, instance) == offsetof(RTCRayHit16, hit.instID));
static_assert(offsetof(RayQuery, valid) == sizeof(RTCRayHit16));

// Rays that meet nothing, and those left out, keep the number that is -1 with a sign.
static_assert(static_cast<std::int32_t>(RTC_INVALID_GEOMETRY_ID) == -1);

void copy_rays(const RayPacket& rays, RayQuery& query) {
  copy16(rays.origin_x, query.origin_x.data());
  copy16(rays.origin_y, query.origin_y.data());
  copy16(rays.origin_z, query.origin_z.data());
  copy16(rays.direction_x, query.direction_x.data());
  copy16(rays.direction_y, query.direction_y.data());
  copy16(rays.direction_z, query.direction_z.data());
  copy16(rays.t_min, query.t_min.data());
  copy16(rays.t_max, query.t_max.data());
  query.valid = rays.valid;
}

/// Quicker than looking for them one by one.
bool has_miss(const RayQuery& query) {
  std::int32_t missed = 0;
  for (std::size_t k = 0; k < kPacketSize; ++k) {
    missed |= query.valid[k] & query.triangle[k];  // -1 and -1
  }
  return missed < 0;
}

/// Turns the rays that missed a little.
void nudge_misses(RayQuery& query, RayQuery::Integers& again) {
  for (std::size_t k = 0; k < kPacketSize; ++k) {
    if (query.valid[k] == 0 || query.triangle[k] >= 0) {
      continue;
    }
    const float length = std::sqrt(query.direction_x[k] * query.direction_x[k] +
                                   (query.direction_y[k] * query.direction_y[k] +
                                    query.direction_z[k] * query.direction_z[k]));
    query.direction_x[k] += length * static_cast<float>(kNudge[0]);
    query.direction_y[k] += length * static_cast<float>(kNudge[1]);
    query.direction_z[k] += length * static_cast<float>(kNudge[2]);
    again[k] = -1;
  }
}

/// Without AVX-512 Embree takes sixteen rays as a stream and does not look at `valid`: only rays
/// that end before they begin are left out everywhere.
void end_before_start(const RayQuery::Integers& valid, float* t_max) {
  for (std::size_t k = 0; k < kPacketSize; ++k) {
    t_max[k] = valid[k] != 0 ? t_max[k] : -std::numeric_limits<float>::infinity();
  }
}

void ask16(RTCScene scene,
           RTCIntersectContext& context,
           const RayQuery::Integers& valid,
           RayQuery& query) {
  const RayQuery::Floats t_max = query.t_max;
  end_before_start(valid, query.t_max.data());
  rtcIntersect16(valid.data(), scene, &context, reinterpret_cast<RTCRayHit16*>(&query));
  for (std::size_t k = 0; k < kPacketSize; ++k) {
    query.t_max[k] = valid[k] != 0 ? query.t_max[k] : t_max[k];
  }
}

double largest_coordinate(const TriangleMesh& mesh) {
  double largest_mm = 0.0;
  for (const Vector3d& vertex : mesh.vertices_mm) {
    largest_mm = std::max(largest_mm, vertex.cwiseAbs().maxCoeff());
  }
  return largest_mm;
}

/// What a search for the nearest point knows on its way.
struct NearestSearch {
  const TriangleMesh& mesh;
  const Vector3d& point_mm;
  double margin_mm = 0.0;  ///< of Embree's distances, which are those of float vertices
  double best_mm = 0.0;
  NearestPoint best = {};
};

/// Embree's callback for a triangle whose box is near enough; true when the radius shrank. Every
/// triangle within the margin of the nearest is seen, so the answer does not depend on the order.
bool look_at_triangle(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<NearestSearch*>(arguments->userPtr);
  const auto triangle = static_cast<std::int32_t>(arguments->primID);
  const Vector3d q = nearest_on_triangle(search.mesh, index(triangle), search.point_mm);
  const double distance_mm = (q - search.point_mm).norm();
  const bool is_tie = distance_mm == search.best_mm &&
                      (search.best.triangle < 0 || triangle < search.best.triangle);
  if (!(distance_mm < search.best_mm) && !is_tie) {
    return false;
  }
  search.best = {.triangle = triangle, .point_mm = q, .distance_mm = distance_mm};
  search.best_mm = distance_mm;
  arguments->query->radius = static_cast<float>(distance_mm + search.margin_mm);
  return true;
}

}  // namespace

struct Bvh::Scene {
  Device device;
  SceneHandle scene;
  std::once_flag has_escape_cone;
  EscapeCone escape_cone;
  std::once_flag has_flat_triangles;
  std::vector<std::uint8_t> flat_triangles;
};

Bvh::Bvh(const TriangleMesh& mesh) : planes_(planes_of(mesh)), scene_(std::make_unique<Scene>()) {
  is_convex_ = is_closed_convex(mesh, planes_);
  largest_mm_ = largest_coordinate(mesh);
  scene_->device = make_device();
  RTCDevice device = scene_->device.get();
  scene_->scene.reset(rtcNewScene(device));
  throw_on_error(device);
  const Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
  throw_on_error(device);
  fill_buffers(geometry.get(), mesh);
  throw_on_error(device);
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene_->scene.get(), geometry.get());
  rtcSetSceneFlags(scene_->scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcCommitScene(scene_->scene.get());
  throw_on_error(device);
}

Bvh::~Bvh() = default;
Bvh::Bvh(Bvh&&) noexcept = default;
Bvh& Bvh::operator=(Bvh&&) noexcept = default;

const EscapeCone& Bvh::escape_cone(const TriangleMesh& mesh) const {
  std::call_once(scene_->has_escape_cone, [&] { scene_->escape_cone = find_escape_cone(mesh); });
  return scene_->escape_cone;
}

const std::vector<std::uint8_t>& Bvh::flat_triangles(const TriangleMesh& mesh) const {
  std::call_once(scene_->has_flat_triangles,
                 [&] { scene_->flat_triangles = find_flat_triangles(mesh, planes_); });
  return scene_->flat_triangles;
}

void Bvh::trace16(RayQuery& query, Coherence coherence) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherence == Coherence::kIncoherent ? RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT
                                                      : RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  ask16(scene_->scene.get(), context, query.valid, query);
  if (coherence == Coherence::kCoherent && has_miss(query)) {
    alignas(64) RayQuery::Integers again = {};
    nudge_misses(query, again);
    ask16(scene_->scene.get(), context, again, query);
  }
}

void Bvh::intersect16(const RayPacket& rays, HitPacket& hits, Coherence coherence) const {
  RayQuery query;
  copy_rays(rays, query);
  trace16(query, coherence);
  hits.t_mm = query.t_max;
  hits.triangle = query.triangle;
  hits.u = query.u;
  hits.v = query.v;
}

void Bvh::occluded16(RayPacket& rays, Coherence coherence) const {
  RTCRay16 packet;
  copy16(rays.origin_x, packet.org_x);
  copy16(rays.origin_y, packet.org_y);
  copy16(rays.origin_z, packet.org_z);
  copy16(rays.direction_x, packet.dir_x);
  copy16(rays.direction_y, packet.dir_y);
  copy16(rays.direction_z, packet.dir_z);
  copy16(rays.t_min, packet.tnear);
  copy16(rays.t_max, packet.tfar);
  end_before_start(rays.valid, packet.tfar);
  std::ranges::fill(packet.time, 0.0F);
  std::ranges::fill(packet.mask, ~0U);
  std::ranges::fill(packet.id, 0U);
  std::ranges::fill(packet.flags, 0U);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherence == Coherence::kIncoherent ? RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT
                                                      : RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(rays.valid.data(), scene_->scene.get(), &context, &packet);
  for (std::size_t k = 0; k < kPacketSize; ++k) {
    rays.valid[k] = packet.tfar[k] < 0.0F ? 0 : rays.valid[k];  // Embree sets -inf
  }
}

Hit Bvh::intersect(const Vector3d& origin_mm,
                   const Vector3d& direction,
                   double t_min_mm,
                   double t_max_mm) const {
  const Vector3d nudge(kNudge[0], kNudge[1], kNudge[2]);
  for (const bool is_nudged : {false, true}) {
    alignas(16) RTCRayHit query = {};
    const Vector3d aim = is_nudged ? Vector3d(direction + direction.norm() * nudge) : direction;
    query.ray = single_ray(origin_mm, aim, t_min_mm, t_max_mm);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.primID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_->scene.get(), &context, &query);
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
      return {.t_mm = query.ray.tfar,
              .triangle = static_cast<std::int32_t>(query.hit.primID),
              .u = query.hit.u,
              .v = query.hit.v};
    }
  }
  return {};
}

bool Bvh::occluded(const Vector3d& origin_mm,
                   const Vector3d& direction,
                   double t_min_mm,
                   double t_max_mm) const {
  alignas(16) RTCRay ray = single_ray(origin_mm, direction, t_min_mm, t_max_mm);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_->scene.get(), &context, &ray);
  return ray.tfar < 0.0F;  // Embree sets -inf
}

std::optional<NearestPoint> Bvh::nearest(const TriangleMesh& mesh,
                                         const Vector3d& point_mm,
                                         double max_distance_mm) const {
  // Floats are good to 6e-8 of the largest coordinate; a few roundings add up.
  constexpr double kFloatMargin = 1e-6;
  const double reach_mm = std::max(largest_mm_, point_mm.cwiseAbs().maxCoeff());
  NearestSearch search = {.mesh = mesh,
                          .point_mm = point_mm,
                          .margin_mm = kFloatMargin * reach_mm,
                          .best_mm = max_distance_mm};
  alignas(16) RTCPointQuery query = {};
  query.x = static_cast<float>(point_mm.x());
  query.y = static_cast<float>(point_mm.y());
  query.z = static_cast<float>(point_mm.z());
  constexpr double kLargestRadius_mm = 1e18;  // its square is still a float
  query.radius =
      static_cast<float>(std::min(max_distance_mm, kLargestRadius_mm) + search.margin_mm);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene_->scene.get(), &query, &context, look_at_triangle, &search);
  if (search.best.triangle < 0) {
    return std::nullopt;
  }
  return search.best;
}

std::string embree_isa() {
  const Device device = make_device();
  const auto has = [&](RTCDeviceProperty property) {
    return rtcGetDeviceProperty(device.get(), property) != 0;
  };
  if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) {
    return "AVX512";
  }
  if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) {
    return __builtin_cpu_supports("avx2") != 0 ? "AVX2" : "AVX";
  }
  return "SSE";
}

}  // namespace glint

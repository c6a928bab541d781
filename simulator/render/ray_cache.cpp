// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/ray_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <unistd.h>

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Reflected rays start this far off the triangle, against hits on the triangle itself. It only
/// decides whether the part is met again; the kept origin is the exact point.
constexpr double kStartOffset_mm = 1e-3;

/// A hit on the exact surface further than this from the triangle's is not believed.
constexpr double kMaxPolishMove_mm = 1.0;

/// Where a ray meets the part, with everything needed to send it on.
struct Interaction {
  Vector3d point_mm;
  Vector3d start_mm;  ///< for the next ray through the triangles
  Vector3d geometric_normal;
  Vector3d direction;  ///< of the reflected ray, unit
};

struct TraceContext {
  const Part& part;
  const Bvh& bvh;
  const SurfaceDetail& detail;
  const RenderSettings& settings;
};

/// One escaping ray of the cache.
struct Escape {
  Vector3d origin_mm = Vector3d::Zero();
  Vector3d direction = -Vector3d::UnitZ();
  double weight = 0.0;
};

Interaction interact(const TraceContext& context, const Ray& ray, const Hit& hit) {
  Interaction at;
  const TriangleMesh& mesh = context.part.mesh;
  const Vector3d on_triangle = hit_point(mesh, hit);
  at.point_mm = on_triangle;
  at.geometric_normal = geometric_normal(mesh, hit);
  Vector3d normal;
  const std::int32_t patch = mesh.patch_of(static_cast<std::size_t>(hit.triangle));
  std::optional<SurfaceHit> exact;
  if (patch >= 0) {
    exact = polish(context.part.patches[static_cast<std::size_t>(patch)],
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
  if (!context.detail.empty()) {
    const SurfaceDetail::Sample sample = context.detail.sample(at.point_mm, normal);
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

/// Follows a ray that meets the part again until it escapes or is given up.
Escape follow(const TraceContext& context, Interaction at, Hit next, RayCounts& counts) {
  double weight = context.settings.reflectance;
  for (int bounce = 1; next; ++bounce) {
    if (bounce >= context.settings.max_bounces) {
      ++counts.blocked;
      return {};
    }
    at = interact(context, {.origin_mm = at.start_mm, .direction = at.direction}, next);
    weight *= context.settings.reflectance;
    if (at.direction.dot(at.geometric_normal) <= 0.0) {
      ++counts.grazing;
      break;
    }
    next = context.bvh.intersect(
        at.start_mm, at.direction, 0.0, std::numeric_limits<double>::infinity());
  }
  ++counts.followed;
  return {.origin_mm = at.point_mm, .direction = at.direction, .weight = weight};
}

void set_ray(RayPacket& packet, std::size_t lane, const Ray& ray) {
  packet.origin_x[lane] = static_cast<float>(ray.origin_mm.x());
  packet.origin_y[lane] = static_cast<float>(ray.origin_mm.y());
  packet.origin_z[lane] = static_cast<float>(ray.origin_mm.z());
  packet.direction_x[lane] = static_cast<float>(ray.direction.x());
  packet.direction_y[lane] = static_cast<float>(ray.direction.y());
  packet.direction_z[lane] = static_cast<float>(ray.direction.z());
  packet.t_min[lane] = 0.0F;
  packet.t_max[lane] = std::numeric_limits<float>::infinity();
  packet.valid[lane] = -1;
}

Hit hit_of(const HitPacket& hits, std::size_t lane) {
  return {.t_mm = hits.t_mm[lane],
          .triangle = hits.triangle[lane],
          .u = hits.u[lane],
          .v = hits.v[lane]};
}

/// Sixteen rays of one row, from the camera until they escape.
struct PacketResult {
  std::array<Escape, kPacketSize> escapes;
  std::array<Interaction, kPacketSize> first;
  std::array<bool, kPacketSize> on_part = {};
};

PacketResult trace_packet(const TraceContext& context,
                          const std::array<Ray, kPacketSize>& rays,
                          std::size_t count,
                          RayCounts& counts) {
  PacketResult result;
  RayPacket packet;
  HitPacket hits;
  for (std::size_t lane = 0; lane < count; ++lane) {
    set_ray(packet, lane, rays[lane]);
  }
  context.bvh.intersect16(packet, hits, Coherence::kCoherent);
  RayPacket reflected;
  std::array<bool, kPacketSize> is_grazing = {};
  for (std::size_t lane = 0; lane < count; ++lane) {
    ++counts.camera;
    const Hit hit = hit_of(hits, lane);
    if (!hit) {
      continue;
    }
    ++counts.part;
    result.on_part[lane] = true;
    Interaction& at = result.first[lane];
    at = interact(context, rays[lane], hit);
    is_grazing[lane] = at.direction.dot(at.geometric_normal) <= 0.0;
    if (!is_grazing[lane]) {
      set_ray(reflected, lane, {.origin_mm = at.start_mm, .direction = at.direction});
    }
  }
  // Mirror-like rays stay close together: the coherent traversal is twice as fast for them.
  context.bvh.intersect16(reflected, hits, Coherence::kCoherent);
  for (std::size_t lane = 0; lane < count; ++lane) {
    if (!result.on_part[lane]) {
      continue;
    }
    const Interaction& at = result.first[lane];
    const Hit again = is_grazing[lane] ? Hit{} : hit_of(hits, lane);
    counts.grazing += is_grazing[lane] ? 1 : 0;
    result.escapes[lane] = again ? follow(context, at, again, counts)
                                 : Escape{.origin_mm = at.point_mm,
                                          .direction = at.direction,
                                          .weight = context.settings.reflectance};
  }
  return result;
}

void store(RayCache& cache, std::size_t index, const Escape& escape) {
  cache.origin_x[index] = static_cast<float>(escape.origin_mm.x());
  cache.origin_y[index] = static_cast<float>(escape.origin_mm.y());
  cache.origin_z[index] = static_cast<float>(escape.origin_mm.z());
  cache.direction_x[index] = static_cast<float>(escape.direction.x());
  cache.direction_y[index] = static_cast<float>(escape.direction.y());
  cache.direction_z[index] = static_cast<float>(escape.direction.z());
  cache.weight[index] = static_cast<float>(escape.weight);
}

/// Traces one row of the image, all samples.
class RowTracer {
 public:
  RowTracer(const TraceContext& context,
            const PinholeCamera& camera,
            const RigidTransform& camera_from_world,
            RayCache& cache)
      : context_(context),
        camera_(camera),
        world_from_camera_(inverse(camera_from_world)),
        cache_(cache) {}

  RayCounts trace(int y) const {
    RayCounts counts;
    const int per_axis = context_.settings.rays_per_axis;
    std::vector<Seen> seen(static_cast<std::size_t>(cache_.width_px));
    for (int sample = 0; sample < cache_.samples; ++sample) {
      const int row = sample / per_axis;
      const int column = sample % per_axis;
      const Vector2d offset((column + 0.5) / per_axis, (row + 0.5) / per_axis);
      for (int x = 0; x < cache_.width_px; x += kPacketSize) {
        trace_pixels({.x = x, .y = y, .sample = sample}, offset, seen, counts);
      }
    }
    for (int x = 0; x < cache_.width_px; ++x) {
      store_seen(seen[static_cast<std::size_t>(x)], x, y);
    }
    return counts;
  }

 private:
  /// First hits of a pixel, counted as integers so that a whole pixel is exactly whole.
  struct Seen {
    int hits = 0;
    Vector3d sum_mm = Vector3d::Zero();
  };

  struct Place {
    int x = 0;
    int y = 0;
    int sample = 0;
  };

  void trace_pixels(const Place& at,
                    const Vector2d& offset,
                    std::vector<Seen>& seen,
                    RayCounts& counts) const {
    const auto count = static_cast<std::size_t>(std::min(kPacketSize, cache_.width_px - at.x));
    std::array<Ray, kPacketSize> rays;
    for (std::size_t lane = 0; lane < count; ++lane) {
      const auto direction =
          camera_.ray_through(Vector2d(at.x + static_cast<double>(lane), at.y) + offset);
      GLINT_CHECK(direction.has_value(), "the camera has a ray for every pixel of its image");
      rays[lane] = {.origin_mm = world_from_camera_.translation_mm,
                    .direction = world_from_camera_.rotation * *direction};
    }
    const PacketResult result = trace_packet(context_, rays, count, counts);
    const auto row = static_cast<std::int64_t>(at.y) * cache_.width_px;
    const auto first = static_cast<std::size_t>(at.sample * cache_.num_pixels() + row + at.x);
    for (std::size_t lane = 0; lane < count; ++lane) {
      store(cache_, first + lane, result.escapes[lane]);
      if (result.on_part[lane]) {
        Seen& pixel = seen[static_cast<std::size_t>(at.x) + lane];
        ++pixel.hits;
        pixel.sum_mm += result.first[lane].point_mm;
      }
    }
  }

  void store_seen(const Seen& seen, int x, int y) const {
    if (seen.hits == 0) {
      return;
    }
    const Vector3d mean_mm = seen.sum_mm / seen.hits;
    cache_.coverage(x, y) = static_cast<float>(seen.hits) / static_cast<float>(cache_.samples);
    cache_.seen_x(x, y) = static_cast<float>(mean_mm.x());
    cache_.seen_y(x, y) = static_cast<float>(mean_mm.y());
    cache_.seen_z(x, y) = static_cast<float>(mean_mm.z());
  }

  const TraceContext& context_;
  const PinholeCamera& camera_;
  RigidTransform world_from_camera_;
  RayCache& cache_;
};

/// Refuses pictures whose rays would not fit into the machine.
void check_memory(const PinholeIntrinsics& in, int samples) {
  const double needed = 28.0 * in.width_px * in.height_px * samples;
  const double available =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  constexpr double kShare = 0.5;
  if (needed > kShare * available) {
    throw ConfigError(
        fmt::format("render.rays_per_axis: {} x {} px with {} rays each need {:.1f} GB for their "
                    "rays, this machine has {:.1f} GB; allowed is half of it",
                    in.width_px,
                    in.height_px,
                    samples,
                    needed * 1e-9,
                    available * 1e-9));
  }
}

RayCache empty_cache(const PinholeIntrinsics& in, int samples) {
  RayCache cache;
  cache.width_px = in.width_px;
  cache.height_px = in.height_px;
  cache.samples = samples;
  for (ImageF* image : {&cache.coverage, &cache.seen_x, &cache.seen_y, &cache.seen_z}) {
    *image = ImageF(in.width_px, in.height_px);
  }
  const auto rays =
      static_cast<std::size_t>(cache.num_pixels()) * static_cast<std::size_t>(samples);
  for (auto* component : {&cache.origin_x,
                          &cache.origin_y,
                          &cache.origin_z,
                          &cache.direction_x,
                          &cache.direction_y,
                          &cache.direction_z,
                          &cache.weight}) {
    component->resize(rays);
  }
  return cache;
}

}  // namespace

void visit_keys(KeyVisitor& keys, RenderSettings& s) {
  keys.integer("rays_per_axis",
               s.rays_per_axis,
               Range::between(1, 16),
               "rays along each side of a pixel; their square is the number of rays a pixel");
  keys.integer("max_bounces",
               s.max_bounces,
               Range::between(1, 64),
               "reflections on the part before a ray is given up as dark (and counted)");
  keys.number("reflectance",
              s.reflectance,
              Range::between(0, 1),
              "of the mirror-like part, per reflection");
}

RayBlock RayCache::block(std::int64_t begin, int count) const {
  return {.origin_x = origin_x.data() + begin,
          .origin_y = origin_y.data() + begin,
          .origin_z = origin_z.data() + begin,
          .direction_x = direction_x.data() + begin,
          .direction_y = direction_y.data() + begin,
          .direction_z = direction_z.data() + begin,
          .count = count};
}

RayBlock RayCache::seen_block(std::int64_t begin, int count) const {
  return {.origin_x = seen_x.values().data() + begin,
          .origin_y = seen_y.values().data() + begin,
          .origin_z = seen_z.values().data() + begin,
          .count = count};
}

RayCache trace_rays(const Part& part,
                    const Bvh& bvh,
                    const SurfaceDetail& detail,
                    const PinholeCamera& camera,
                    const RigidTransform& camera_from_world,
                    const RenderSettings& settings,
                    ThreadPool& pool) {
  const int samples = settings.rays_per_axis * settings.rays_per_axis;
  check_memory(camera.intrinsics(), samples);
  RayCache cache = empty_cache(camera.intrinsics(), samples);
  const TraceContext context = {.part = part, .bvh = bvh, .detail = detail, .settings = settings};
  const RowTracer tracer(context, camera, camera_from_world, cache);
  const auto per_row = pool.map<RayCounts>(
      cache.height_px, [&](std::int64_t y) { return tracer.trace(static_cast<int>(y)); });
  for (const RayCounts& row : per_row) {
    cache.counts.camera += row.camera;
    cache.counts.part += row.part;
    cache.counts.followed += row.followed;
    cache.counts.blocked += row.blocked;
    cache.counts.grazing += row.grazing;
  }
  if (cache.counts.part == 0) {
    throw ConfigError(
        "camera: the part is outside the image: no camera ray meets it; check viewpoint, "
        "working_distance_mm and part.position_mm");
  }
  return cache;
}

}  // namespace glint

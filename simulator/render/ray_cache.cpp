// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/ray_cache.h"

#include <algorithm>

#include <fmt/format.h>

#include "simulator/render/packet_tracer.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr std::array<std::string_view, 5> kMethodNames = {
    "auto", "sampled", "integrated", "closed", "paths"};

/// Traces one row of the image, all samples.
class RowTracer {
 public:
  RowTracer(const TraceScene& scene, const CameraRays& camera, RayCache& cache)
      : scene_(scene), camera_(camera), area_(camera.area_of(scene.box)), cache_(cache) {}

  RayCounts trace(int y) const {
    RayCounts counts;
    Work work = {.tracer = PacketTracer(scene_)};
    const int per_axis = scene_.settings.rays_per_axis;
    if (cache_.samples > 1) {
      work.sums.resize(4 * static_cast<std::size_t>(cache_.width_px));
    }
    for (int sample = 0; sample < cache_.samples; ++sample) {
      const int row = sample / per_axis;
      const int column = sample % per_axis;
      const Vector2d offset((column + 0.5) / per_axis, (row + 0.5) / per_axis);
      for (int x = 0; x < cache_.width_px; x += kPacketSize) {
        trace_pixels({.x = x, .y = y, .sample = sample}, offset, work, counts);
      }
    }
    if (cache_.samples > 1 && counts.part > 0) {
      mean_seen(seen_of(work, 0),
                cache_.samples,
                cache_.width_px,
                cache_.coverage.row(y),
                cache_.seen_x.row(y),
                cache_.seen_y.row(y),
                cache_.seen_z.row(y));
    }
    return counts;
  }

 private:
  struct Work {
    PacketTracer tracer;
    CameraPacket rays = {};
    EscapePacket escapes = {};
    std::vector<double> sums = {};  ///< of what the samples of each pixel of the row saw
  };

  struct Place {
    int x = 0;
    int y = 0;
    int sample = 0;
  };

  SeenSums seen_of(Work& work, int x) const {
    const std::ptrdiff_t width = cache_.width_px;
    double* first = work.sums.data() + x;
    return {
        .hits = first, .x_mm = first + width, .y_mm = first + 2 * width, .z_mm = first + 3 * width};
  }

  void trace_pixels(const Place& at, const Vector2d& offset, Work& work, RayCounts& counts) const {
    const int count = std::min(kPacketSize, cache_.width_px - at.x);
    const auto row = static_cast<std::int64_t>(at.y) * cache_.width_px;
    const auto first = static_cast<std::size_t>(at.sample * cache_.num_pixels() + row + at.x);
    if (!area_.touches(at.x, at.x + count, at.y, at.y + 1)) {
      store_missed(first, static_cast<std::size_t>(count), cache_);
      counts.camera += count;
      return;
    }
    alignas(64) Lanes x_px;
    alignas(64) Lanes y_px;
    row_points16(at.x, at.y, offset.data(), x_px.data(), y_px.data());
    camera_.through(x_px.data(), y_px.data(), count, work.rays);
    work.tracer.trace(work.rays, work.escapes);
    add_counts(work.escapes, count, counts);
    store_rays(work.escapes, count, cache_, first);
    if (!work.escapes.is_missed) {
      store_seen(at, count, work);
    }
  }

  void store_seen(const Place& at, int count, Work& work) const {
    const EscapePacket& escapes = work.escapes;
    if (cache_.samples > 1) {
      add_seen(escapes.seen_x.data(),
               escapes.seen_y.data(),
               escapes.seen_z.data(),
               escapes.is_seen.data(),
               count,
               seen_of(work, at.x));
      return;
    }
    one_seen(escapes.seen_x.data(),
             escapes.seen_y.data(),
             escapes.seen_z.data(),
             escapes.is_seen.data(),
             count,
             cache_.coverage.row(at.y) + at.x,
             cache_.seen_x.row(at.y) + at.x,
             cache_.seen_y.row(at.y) + at.x,
             cache_.seen_z.row(at.y) + at.x);
  }

  const TraceScene& scene_;
  const CameraRays& camera_;
  ImageArea area_;  ///< outside of which no ray meets the part
  RayCache& cache_;
};

RayCache empty_cache(const PinholeIntrinsics& in, int samples) {
  RayCache cache;
  cache.width_px = in.width_px;
  cache.height_px = in.height_px;
  cache.samples = samples;
  for (ImageF* image : {&cache.coverage, &cache.seen_x, &cache.seen_y, &cache.seen_z}) {
    *image = ImageF(in.width_px, in.height_px);
  }
  resize_rays(cache,
              static_cast<std::size_t>(cache.num_pixels()) * static_cast<std::size_t>(samples));
  return cache;
}

}  // namespace

std::string_view method_name(RenderSettings::Method method) {
  return kMethodNames[static_cast<std::size_t>(method)];
}

void visit_keys(KeyVisitor& keys, RenderSettings& s) {
  keys.choice("method",
              s.method,
              kMethodNames,
              "how pictures come about: auto = closed forms in a search, integrated footprints for "
              "pictures, paths where light or material need it; sampled = rays_per_axis^2 point "
              "samples a pixel; paths = path tracing");
  keys.integer("rays_per_axis",
               s.rays_per_axis,
               Range::between(1, 16),
               "sampled: rays along each side of a pixel; their square is the number of rays");
  keys.number("max_direction_error_mrad",
              s.max_direction_error_rad,
              Range::between(1e-3, 100),
              "not sampled: largest error of reflected rays taken as linear across a cell of a "
              "pixel; smaller = more cells where the surface is bent");
  keys.integer("max_bounces",
               s.max_bounces,
               Range::between(1, 64),
               "reflections on the part before a ray is given up as dark (and counted)");
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

RayBlock SeenPart::seen_block(std::int64_t begin, int count) const {
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
  const PinholeIntrinsics& in = camera.intrinsics();
  check_ray_memory(static_cast<double>(in.width_px) * in.height_px * samples,
                   fmt::format("render.rays_per_axis: {} x {} px with {} rays each",
                               in.width_px,
                               in.height_px,
                               samples));
  RayCache cache = empty_cache(in, samples);
  const TraceScene scene(part, bvh, detail, settings);
  const CameraRays camera_rays(camera, camera_from_world);
  const RowTracer tracer(scene, camera_rays, cache);
  const auto per_row = pool.map<RayCounts>(
      cache.height_px, [&](std::int64_t y) { return tracer.trace(static_cast<int>(y)); });
  for (const RayCounts& row : per_row) {
    cache.counts += row;
  }
  check_part_is_seen(cache.counts);
  return cache;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/ray_cache/ray_cache.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/image/mask_kernels.h"
#include "simulator/render/ray_cache/packet_tracer.h"
#include "simulator/render/ray_cache/seen_kernels.h"

namespace glint {
namespace {

using Eigen::Vector2d;

/// Traces one row of the image, all samples.
class RowTracer {
 public:
  RowTracer(const TraceScene& scene, const CameraRays& camera, RayCache& cache)
      : scene_(scene), camera_(camera), area_(camera.area_of(scene.box)), cache_(cache) {
    set_reached();
    int rows = 0;
    for (int y = 0; y < cache.height_px; ++y) {
      rows += is_row_reached(y) ? 1 : 0;
    }
    const double reached = static_cast<double>(reached_.end - reached_.begin) * rows;
    is_cleared_ = reached < kClearedBelow * static_cast<double>(cache.num_pixels());
  }

  /// To be called for [0, num_stretches()) before the first row.
  void clear(std::int64_t stretch) const {
    const std::int64_t pixels = cache_.num_pixels();
    const std::int64_t begin = stretch * kStretch;
    const std::int64_t count = std::min(kStretch, pixels * cache_.samples - begin);
    store_missed(static_cast<std::size_t>(begin), static_cast<std::size_t>(count), cache_);
    for (ImageF* image : seen_images()) {
      const std::int64_t end = std::min(begin + count, pixels);
      std::fill(
          image->values().begin() + std::min(begin, end), image->values().begin() + end, 0.0F);
    }
  }

  std::int64_t num_stretches() const {
    return is_cleared_ ? (cache_.num_pixels() * cache_.samples + kStretch - 1) / kStretch : 0;
  }

  RayCounts trace(int y) const {
    const Span pixels = is_row_reached(y) ? reached_ : Span{};
    RayCounts counts;
    counts.camera =
        static_cast<std::int64_t>(cache_.width_px - (pixels.end - pixels.begin)) * cache_.samples;
    if (!is_cleared_) {
      clear_beside(pixels, y);
    }
    if (pixels.begin == pixels.end) {
      return counts;
    }
    Work work = {.tracer = PacketTracer(scene_)};
    const int per_axis = scene_.settings.rays_per_axis;
    if (cache_.samples > 1) {
      work.sums.resize(4 * static_cast<std::size_t>(cache_.width_px));
    }
    for (int sample = 0; sample < cache_.samples; ++sample) {
      const int row = sample / per_axis;
      const int column = sample % per_axis;
      const Vector2d offset((column + 0.5) / per_axis, (row + 0.5) / per_axis);
      for (int x = pixels.begin; x < pixels.end; x += kPacketSize) {
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

  /// Memory is written fastest in long stretches: where the part reaches less of the image than
  /// this share, all rays are first set as if they missed it.
  static constexpr double kClearedBelow = 0.75;
  static constexpr std::int64_t kStretch = 1 << 16;

  /// Pixels [begin, end) of a row.
  struct Span {
    int begin = 0;
    int end = 0;
  };

  struct Place {
    int x = 0;
    int y = 0;
    int sample = 0;
  };

  std::size_t ray_of(const Place& at) const {
    return static_cast<std::size_t>(at.sample * cache_.num_pixels() +
                                    static_cast<std::int64_t>(at.y) * cache_.width_px + at.x);
  }

  std::array<ImageF*, 4> seen_images() const {
    return {&cache_.coverage, &cache_.seen_x, &cache_.seen_y, &cache_.seen_z};
  }

  /// The pixels of a row that may see the part, in whole packets: rays of all others miss it.
  void set_reached() {
    const int width = cache_.width_px;
    const auto is_reached = [&](int x) {
      return std::min(x + kPacketSize, width) >= area_.min_x && x <= area_.max_x;
    };
    while (reached_.begin < width && !is_reached(reached_.begin)) {
      reached_.begin = std::min(reached_.begin + kPacketSize, width);
    }
    reached_.end = reached_.begin;
    while (reached_.end < width && is_reached(reached_.end)) {
      reached_.end = std::min(reached_.end + kPacketSize, width);
    }
  }

  bool is_row_reached(int y) const { return area_.touches(0, cache_.width_px, y, y + 1); }

  /// What no packet of a row writes.
  void clear_beside(const Span& pixels, int y) const {
    for (ImageF* image : seen_images()) {
      std::fill_n(image->row(y), cache_.width_px, 0.0F);
    }
    for (int sample = 0; sample < cache_.samples; ++sample) {
      store_missed(ray_of({.x = 0, .y = y, .sample = sample}),
                   static_cast<std::size_t>(pixels.begin),
                   cache_);
      store_missed(ray_of({.x = pixels.end, .y = y, .sample = sample}),
                   static_cast<std::size_t>(cache_.width_px - pixels.end),
                   cache_);
    }
  }

  SeenSums seen_of(Work& work, int x) const {
    const std::ptrdiff_t width = cache_.width_px;
    double* first = work.sums.data() + x;
    return {
        .hits = first, .x_mm = first + width, .y_mm = first + 2 * width, .z_mm = first + 3 * width};
  }

  void trace_pixels(const Place& at, const Vector2d& offset, Work& work, RayCounts& counts) const {
    const int count = std::min(kPacketSize, cache_.width_px - at.x);
    alignas(64) Lanes x_px;
    alignas(64) Lanes y_px;
    row_points16(at.x, at.y, offset.data(), x_px.data(), y_px.data());
    camera_.through(x_px.data(), y_px.data(), count, work.rays);
    work.tracer.trace(work.rays, work.escapes);
    add_counts(work.escapes, count, counts);
    store_rays(work.escapes, count, cache_, ray_of(at));
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
  Span reached_;             ///< pixels of a row
  bool is_cleared_ = false;  ///< before the first row
};

/// All numbers unset.
RayCache uninitialized_cache(const PlacedCamera& placed, int samples) {
  const PinholeIntrinsics& in = placed.camera.intrinsics();
  RayCache cache;
  cache.camera = placed;
  cache.width_px = in.width_px;
  cache.height_px = in.height_px;
  cache.samples = samples;
  for (ImageF* image : {&cache.coverage, &cache.seen_x, &cache.seen_y, &cache.seen_z}) {
    *image = ImageF::uninitialized(in.width_px, in.height_px);
  }
  resize_rays(cache,
              static_cast<std::size_t>(cache.num_pixels()) * static_cast<std::size_t>(samples));
  return cache;
}

}  // namespace

RayBlock RayCache::block(std::int64_t begin, int count) const {
  return {.origin_x = origin_x.data() + begin,
          .origin_y = origin_y.data() + begin,
          .origin_z = origin_z.data() + begin,
          .direction_x = direction_x.data() + begin,
          .direction_y = direction_y.data() + begin,
          .direction_z = direction_z.data() + begin,
          .count = count};
}

RayBlock VisibilityBuffer::seen_points(std::int64_t begin, int count) const {
  return {.origin_x = seen_x.values().data() + begin,
          .origin_y = seen_y.values().data() + begin,
          .origin_z = seen_z.values().data() + begin,
          .count = count};
}

double share_of_part(const Mask& mask, const VisibilityBuffer& seen) {
  const auto count = static_cast<int>(mask.size());
  const int marked = mask_kernels::count_ones(mask.values().data(), count);
  const int on_part = mask_kernels::count_positive(seen.coverage.values().data(), count);
  return on_part > 0 ? static_cast<double>(marked) / on_part : 0.0;
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
  RayCache cache = uninitialized_cache({camera, camera_from_world}, samples);
  const TraceScene scene(part, bvh, detail, settings);
  const CameraRays camera_rays(camera, camera_from_world);
  const RowTracer tracer(scene, camera_rays, cache);
  pool.for_each(tracer.num_stretches(), [&](std::int64_t i) { tracer.clear(i); });
  const auto per_row = pool.map<RayCounts>(
      cache.height_px, [&](std::int64_t y) { return tracer.trace(static_cast<int>(y)); });
  for (const RayCounts& row : per_row) {
    cache.counts += row;
  }
  check_part_is_seen(cache.counts);
  return cache;
}

}  // namespace glint

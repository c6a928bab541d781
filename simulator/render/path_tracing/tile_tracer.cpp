// SPDX-License-Identifier: GPL-3.0-or-later
//
// Path tracing of one tile of 8 x 8 pixels. All paths of a batch (8 samples of 64 pixels) take each
// step together: find the surface, draw a direction to a light, draw one from the material, trace
// the shadow rays. Paths that go on are packed without gaps into packets of sixteen, so that Embree
// and the kernels always work on full ones. Light sampling and material sampling are combined by
// the power heuristic (Veach and Guibas 1995). docs/theory/path_tracing.md, "Packets". Cost: per
// reflection one ray and at most one shadow ray for each path. Memory: the packets of 512 paths per
// thread.
#include "simulator/render/path_tracing/tile_tracer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "core/wall_clock.h"
#include "simulator/render/path_tracing/sobol.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A light is not hidden by what lies this share of its distance in front of it: rounding to float.
constexpr float kShortOfLight = 1e-5F;

/// So many paths are followed together: their data stay in the second-level cache.
constexpr int kSamplesTogether = 8;

void copy_ray(const RayPacket& from, std::size_t lane, RayPacket& to, std::size_t to_lane) {
  to.origin_x[to_lane] = from.origin_x[lane];
  to.origin_y[to_lane] = from.origin_y[lane];
  to.origin_z[to_lane] = from.origin_z[lane];
  to.direction_x[to_lane] = from.direction_x[lane];
  to.direction_y[to_lane] = from.direction_y[lane];
  to.direction_z[to_lane] = from.direction_z[lane];
  to.t_max[to_lane] = from.t_max[lane];
  to.valid[to_lane] = from.valid[lane];
}

}  // namespace

PathPacket& TileTracer::Wave::next() {
  const std::size_t at = paths++ / kPacketLanes;
  if (at == packets.size()) {
    packets.emplace_back();
  }
  return packets[at];
}

void TileTracer::Wave::append(const PathPacket& from, std::size_t lane) {
  const std::size_t to = paths % kPacketLanes;
  PathPacket& packet = next();
  copy_ray(from.ray, lane, packet.ray, to);
  packet.hit.t_mm[to] = from.hit.t_mm[lane];
  packet.hit.triangle[to] = from.hit.triangle[lane];
  packet.hit.u[to] = from.hit.u[lane];
  packet.hit.v[to] = from.hit.v[lane];
  for (auto& channel : packet.weight.c) {
    const auto c = &channel - packet.weight.c;
    channel[to] = from.weight.c[c][lane];
  }
  packet.density[to] = from.density[lane];
  packet.seed[to] = from.seed[lane];
  packet.index[to] = from.index[lane];
  packet.path[to] = from.path[lane];
}

void TileTracer::Wave::append(const PathPacket& from) {
  PathPacket& packet = next();
  paths += kPacketLanes - 1;
  if (&packet != &from) {
    packet = from;
  }
}

void TileTracer::Wave::finish() {
  for (std::size_t lane = paths % kPacketLanes; lane != 0 && lane < kPacketLanes; ++lane) {
    PathPacket& packet = packets[paths / kPacketLanes];
    packet.ray.valid[lane] = 0;
    packet.hit.triangle[lane] = -1;
  }
}

TileTracer::TileTracer(const PathTask& task)
    : task_(task),
      stages_(task),
      tile_sums_(task.factors, task.settings.channels, task.ids),
      arriving_(),
      light_() {}

void TileTracer::trace(const Tile& tile, int first, int count, Film& sums) {
  tile_sums_.clear();
  for (int done = 0; done < count; done += kSamplesTogether) {
    start(tile, first + done, std::min(kSamplesTogether, count - done));
    if (task_.settings.has_light) {
      for (std::size_t i = 0; i < wave_.num_packets(); ++i) {
        look_at_lights(wave_.packets[i], true);
      }
    }
    keep_hits(wave_);
    look_at_part();
    if (!task_.settings.has_light) {
      continue;
    }
    for (int r = 1; r <= task_.settings.max_reflections && wave_.paths > 0; ++r) {
      reflect_all(r);
    }
    for (std::size_t i = 0; i < totals_.size(); ++i) {
      tile_sums_.add_square(pixels_[i], totals_[i]);
    }
  }
  counts_.dropped += tile_sums_.dropped();
  tile_sums_.add_to(tile, count, sums);
}

void TileTracer::start(const Tile& tile, int first, int count) {
  start_pixels(tile, count);
  wave_.paths = pixels_.size();
  while (wave_.packets.size() < wave_.num_packets()) {
    wave_.packets.emplace_back();
  }
  for (std::size_t p = 0; p < wave_.num_packets(); ++p) {
    PathPacket& packet = wave_.packets[p];
    packet.ray.valid.fill(-1);
    packet.ray.t_max.fill(kInfinity);
    std::ranges::fill(packet.density, 0.0F);
    for (auto& channel : packet.weight.c) {
      std::ranges::fill(channel, 1.0F);
    }
    const std::size_t lanes = std::min(kPacketLanes, wave_.paths - kPacketLanes * p);
    for (std::size_t i = 0; i < lanes; ++i) {
      const std::size_t path = kPacketLanes * p + i;
      packet.seed[i] = seeds_[pixels_[path]];
      packet.index[i] = static_cast<std::uint32_t>(first) +
                        static_cast<std::uint32_t>(path) % static_cast<std::uint32_t>(count);
      packet.path[i] = static_cast<std::uint32_t>(path);
    }
  }
  wave_.finish();
  totals_.assign(pixels_.size(), 0.0);
  aim_cameras(tile);
  const auto begin = std::chrono::steady_clock::now();
  trace_wave(wave_, Coherence::kCoherent);
  counts_.camera_s += seconds_since(begin);
  counts_.camera += static_cast<std::int64_t>(wave_.paths);
}

/// Paths in the order 2 x 2 pixels, samples: those of a packet stay close together.
void TileTracer::start_pixels(const Tile& tile, int count) {
  const PinholeIntrinsics& in = task_.scene.camera.intrinsics();
  pixels_.clear();
  for (int block = 0; block < kTileWidth_px * kTileWidth_px / 4; ++block) {
    for (int i = 0; i < 4; ++i) {
      const int x = 2 * (block % (kTileWidth_px / 2)) + i % 2;
      const int y = 2 * (block / (kTileWidth_px / 2)) + i / 2;
      if (x >= tile.width_px || y >= tile.height_px) {
        continue;
      }
      const auto pixel = static_cast<TilePixel>(kTileWidth_px * y + x);
      const auto number = static_cast<std::uint32_t>((tile.y_px + y) * in.width_px + tile.x_px + x);
      seeds_[pixel] = pixel_seed(number, static_cast<std::uint32_t>(task_.settings.seed));
      columns_[pixel] = static_cast<float>((tile.x_px + x - in.center_px.x()) / in.focal_px.x());
      rows_[pixel] = static_cast<float>((tile.y_px + y - in.center_px.y()) / in.focal_px.y());
      pixels_.insert(pixels_.end(), static_cast<std::size_t>(count), pixel);
    }
  }
}

void TileTracer::aim_cameras(const Tile& tile) {
  for (std::size_t p = 0; p < wave_.num_packets(); ++p) {
    PathPacket& packet = wave_.packets[p];
    const std::size_t lanes = std::min(kPacketLanes, wave_.paths - kPacketLanes * p);
    if (!task_.camera_numbers) {
      for (std::size_t i = 0; i < lanes; ++i) {
        aim_camera(tile, packet, i);
      }
      continue;
    }
    CameraLanes camera = {};
    random_pairs16(packet.seed, packet.index, kPixelPair, camera.x_px, camera.y_px);
    if (task_.camera_numbers->aperture_mm > 0.0F) {
      random_pairs16(packet.seed, packet.index, kLensPair, camera.lens_u, camera.lens_v);
    }
    for (std::size_t i = 0; i < lanes; ++i) {
      camera.column[i] = columns_[pixels_[packet.path[i]]];
      camera.row[i] = rows_[pixels_[packet.path[i]]];
    }
    camera_rays16(*task_.camera_numbers, camera, packet.ray);
  }
}

/// A camera with distortion.
void TileTracer::aim_camera(const Tile& tile, PathPacket& packet, std::size_t lane) const {
  const TilePixel pixel = pixels_[packet.path[lane]];
  const SobolSampler numbers = {.seed = packet.seed[lane], .index = packet.index[lane]};
  const auto within = numbers.pair(kPixelPair);
  const Ray ray = camera_ray(task_,
                             {tile.x_px + static_cast<int>(pixel % kTileWidth_px) + within[0],
                              tile.y_px + static_cast<int>(pixel / kTileWidth_px) + within[1]},
                             numbers);
  packet.ray.origin_x[lane] = static_cast<float>(ray.origin_mm.x());
  packet.ray.origin_y[lane] = static_cast<float>(ray.origin_mm.y());
  packet.ray.origin_z[lane] = static_cast<float>(ray.origin_mm.z());
  packet.ray.direction_x[lane] = static_cast<float>(ray.direction.x());
  packet.ray.direction_y[lane] = static_cast<float>(ray.direction.y());
  packet.ray.direction_z[lane] = static_cast<float>(ray.direction.z());
}

void TileTracer::trace_wave(Wave& wave, Coherence coherence) {
  for (std::size_t i = 0; i < wave.num_packets(); ++i) {
    task_.scene.bvh.intersect16(wave.packets[i].ray, wave.packets[i].hit, coherence);
  }
}

/// Closes the gaps that rays past the part leave; paths that ended at a light stay for the pictures
/// of the part.
void TileTracer::keep_hits(Wave& wave) {
  const std::size_t num_packets = wave.num_packets();
  wave.clear();
  for (std::size_t p = 0; p < num_packets; ++p) {
    const PathPacket& packet = wave.packets[p];
    const auto& triangles = packet.hit.triangle;
    if (wave.paths % kPacketLanes == 0 &&
        std::ranges::all_of(triangles, [](auto t) { return t >= 0; })) {
      wave.append(packet);
      continue;
    }
    for (std::size_t i = 0; i < kPacketLanes; ++i) {
      if (triangles[i] >= 0) {
        wave.append(packet, i);
      }
    }
  }
  wave.finish();
}

/// What the camera rays met, for the pictures that need no light.
void TileTracer::look_at_part() {
  const Vector3d axis = task_.scene_from_camera.rotation.col(2);
  surfaces_.resize(std::max(surfaces_.size(), wave_.num_packets()));
  for (std::size_t p = 0; p < wave_.num_packets(); ++p) {
    const PathPacket& packet = wave_.packets[p];
    SurfaceLanes& surface = surfaces_[p];
    stages_.intersect(packet, surface);
    for (std::size_t i = 0; i < kPacketLanes && packet.hit.triangle[i] >= 0; ++i) {
      tile_sums_.add_surface(pixels_[packet.path[i]], surface, packet, axis, i);
    }
  }
}

/// Adds the light that rays met before the part; those that go on to the part stay valid.
void TileTracer::look_at_lights(PathPacket& packet, bool is_camera) {
  LightHitLanes lights;
  stages_.hit_lights(packet, is_camera, lights);
  arrive16(packet, !is_camera, lights, arriving_);
  for (std::size_t i = 0; i < kPacketLanes; ++i) {
    if (arriving_.is_bright[i] != 0) {
      add_light(
          packet.path[i],
          lights.group[i],
          {arriving_.radiance.c[0][i], arriving_.radiance.c[1][i], arriving_.radiance.c[2][i]});
    }
    const bool goes_on = packet.hit.triangle[i] >= 0 && lights.is_hit[i] == 0;
    packet.ray.valid[i] = goes_on ? packet.ray.valid[i] : 0;
  }
}

void TileTracer::add_light(std::uint32_t path,
                           std::int32_t group,
                           const std::array<float, 3>& radiance) {
  totals_[path] += tile_sums_.add_light(pixels_[path], group, radiance);
}

void TileTracer::reflect_all(int reflection) {
  pending_.clear();
  next_.clear();
  for (std::size_t p = 0; p < wave_.num_packets(); ++p) {
    if (reflection > 1) {  // the first is known from look_at_part()
      stages_.intersect(wave_.packets[p], surfaces_[p]);
    }
    reflect(wave_.packets[p], surfaces_[p], reflection);
  }
  trace_shadows();
  next_.finish();
  const auto begin = std::chrono::steady_clock::now();
  trace_wave(next_, task_.bounces);
  counts_.bounce_s += seconds_since(begin);
  counts_.bounce += static_cast<std::int64_t>(next_.paths);
  for (std::size_t p = 0; p < next_.num_packets(); ++p) {
    look_at_lights(next_.packets[p], false);
    for (std::size_t i = 0; i < kPacketLanes; ++i) {
      PathPacket& packet = next_.packets[p];
      packet.hit.triangle[i] = packet.ray.valid[i] != 0 ? packet.hit.triangle[i] : -1;
    }
  }
  keep_hits(next_);
  std::swap(wave_, next_);
}

void TileTracer::reflect(PathPacket& packet, SurfaceLanes& surface, int reflection) {
  const std::uint32_t pair =
      kFirstReflectionPair + kPairsPerReflection * static_cast<std::uint32_t>(reflection - 1);
  const bool has_roulette = reflection >= task_.settings.roulette_from;
  RandomLanes random;
  random_pairs16(packet.seed, packet.index, pair, random.light_u, random.light_v);
  random_pairs16(packet.seed, packet.index, pair + 1, random.lobe_u, random.lobe_v);
  if (has_roulette || task_.needs_choice) {
    random_pairs16(packet.seed, packet.index, pair + 2, random.choice, random.roulette);
  }
  for (auto& channel : packet.weight.c) {
    for (std::size_t i = 0; i < kPacketLanes; ++i) {
      channel[i] *= surface.reflectance[i];
    }
  }
  ReflectionLanes reflected;
  LeavingLanes leaving;
  const bool has_asked = stages_.ask_lights(packet, surface, random, light_);
  stages_.reflect(packet, surface, random, has_asked ? &light_ : nullptr, reflected, leaving);
  if (has_asked) {
    connect16(packet, surface, light_, reflected, arriving_);
    ask_for(packet, surface);
  }
  alignas(64) std::int32_t is_open[kPacketSize];
  leave16(surface, leaving, has_roulette ? random.roulette : nullptr, packet, is_open);
  go_on(packet, is_open);
}

/// Light of drawn directions: where nothing can be in the way at once, else after a shadow ray.
void TileTracer::ask_for(const PathPacket& packet, const SurfaceLanes& surface) {
  for (std::size_t i = 0; i < kPacketLanes; ++i) {
    if (arriving_.is_bright[i] == 0) {
      continue;
    }
    const std::array<float, 3> radiance = {
        arriving_.radiance.c[0][i], arriving_.radiance.c[1][i], arriving_.radiance.c[2][i]};
    if (arriving_.is_open[i] != 0) {
      add_light(packet.path[i], light_.group[i], radiance);
      continue;
    }
    const std::size_t at = pending_.size() / kPacketLanes;
    const std::size_t lane = pending_.size() % kPacketLanes;
    if (at == shadows_.size()) {
      shadows_.emplace_back();
    }
    RayPacket& ray = shadows_[at];
    if (lane == 0) {
      ray.valid.fill(0);
    }
    ray.origin_x[lane] = surface.start.x[i];
    ray.origin_y[lane] = surface.start.y[i];
    ray.origin_z[lane] = surface.start.z[i];
    ray.direction_x[lane] = light_.direction.x[i];
    ray.direction_y[lane] = light_.direction.y[i];
    ray.direction_z[lane] = light_.direction.z[i];
    ray.t_max[lane] = light_.distance[i] * (1.0F - kShortOfLight);
    ray.valid[lane] = -1;
    pending_.push_back({.path = packet.path[i], .group = light_.group[i], .radiance = radiance});
  }
}

/// Paths that can meet the part again wait for their rays; the others end at a light or in the
/// dark.
void TileTracer::go_on(PathPacket& packet, const std::int32_t* is_open) {
  bool has_open = false;
  for (std::size_t i = 0; i < kPacketLanes; ++i) {
    packet.hit.triangle[i] = -1;
    if (packet.ray.valid[i] == 0) {
      continue;
    }
    if (is_open[i] != 0) {
      has_open = true;
      continue;
    }
    next_.append(packet, i);
    packet.ray.valid[i] = 0;
  }
  if (has_open) {
    look_at_lights(packet, false);
  }
}

void TileTracer::trace_shadows() {
  const auto begin = std::chrono::steady_clock::now();
  const std::size_t num_packets = (pending_.size() + kPacketLanes - 1) / kPacketLanes;
  for (std::size_t p = 0; p < num_packets; ++p) {
    task_.scene.bvh.occluded16(shadows_[p], Coherence::kIncoherent);
  }
  counts_.shadow_s += seconds_since(begin);
  counts_.shadow += static_cast<std::int64_t>(pending_.size());
  for (std::size_t i = 0; i < pending_.size(); ++i) {
    if (shadows_[i / kPacketLanes].valid[i % kPacketLanes] != 0) {
      add_light(pending_[i].path, pending_[i].group, pending_[i].radiance);
    }
  }
}

}  // namespace glint

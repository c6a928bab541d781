// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reference method: frames from point samples of the cached rays. Each ray is intersected with
// the wall once per lighting, in blocks that stay in the first-level cache, and then asked once per
// frame whether a bright stripe stands at its hit, eight frames at a time so that rays are read
// once for all of them. Rays that the wall stops on their way to the camera are dark.
// docs/theory/tunnel.md. Cost: one test per ray and frame; a point sees an edge or does not, so the
// error falls only slowly with the number of rays (footprints.md is the way out). Memory: 8 bytes
// per ray, 12 with oblique stripes.
#include "simulator/render/scan/scan.h"

#include <algorithm>
#include <array>

#include "simulator/render/footprint/visible_part.h"
#include "simulator/render/scan/hidden_rays.h"

namespace glint {
namespace {

/// Rays that are worked on together: their arrays stay in the first caches.
constexpr std::int64_t kBlock = 4096;

/// Small enough that a block's rays stay in the first caches from one frame to the next.
constexpr int kBlockOfFrames = 1024;

/// Frames that are rendered together: rays are read once for all of them.
constexpr std::size_t kFramesAtOnce = 8;

void multiply_gains(const float* __restrict weight, int count, float* __restrict gain) {
  for (int i = 0; i < count; ++i) {
    gain[i] *= weight[i];
  }
}

int block_size(std::int64_t begin, std::int64_t count) {
  return static_cast<int>(std::min(kBlock, count - begin));
}

/// Gain times the radiance of dark stripes where each ray meets the wall.
std::vector<float> shine_of(const RayCache& cache,
                            const Tunnel& tunnel,
                            const std::vector<float>& gain) {
  std::vector<float> shine(gain.size());
  std::vector<float> x(static_cast<std::size_t>(kBlock)), y(x), margin(x);
  const auto total = static_cast<std::int64_t>(gain.size());
  for (std::int64_t begin = 0; begin < total; begin += kBlock) {
    const int count = block_size(begin, total);
    tunnel.intersect_block(cache.block(begin, count), x.data(), y.data(), margin.data());
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const auto ray = static_cast<std::size_t>(begin) + k;
      if (gain[ray] > 0.0F) {
        const double dark =
            tunnel.dark().at(static_cast<double>(y[k]), static_cast<double>(margin[k]));
        shine[ray] = gain[ray] * static_cast<float>(dark);
      }
    }
  }
  return shine;
}

/// The light of dark stripes that depends on the place: what they have in common with bright ones
/// is as bright everywhere, the rest is that of bright stripes beside black ones.
/// @param begin  of the rays that are added
/// @param q_mm   from there on
void add_shining_stripes(const WallRays& rays,
                         std::int64_t begin,
                         const float* q_mm,
                         int count,
                         const StripePattern& pattern,
                         float scale,
                         float* out) {
  const float* x_mm = rays.x_mm.data() + begin;
  const float* gain = rays.gain.data() + begin;
  const float* shine = rays.shine.data() + begin;
  std::array<float, kBlockOfFrames> rest = {};
  for (int i = 0; i < count; ++i) {
    rest[static_cast<std::size_t>(i)] = gain[i] - shine[i];
  }
  add_stripes(x_mm, q_mm, rest.data(), count, pattern, scale, out);
  StripePattern even = pattern;
  even.dark = 1.0F;
  add_stripes(x_mm, q_mm, shine, count, even, scale, out);
}

}  // namespace

WallRays intersect_wall(const RayCache& cache,
                        const Tunnel& tunnel,
                        const Eigen::Vector3d& camera_in_world_mm) {
  const std::int64_t pixels = cache.num_pixels();
  const std::size_t total = cache.weight.size();
  WallRays rays;
  rays.x_mm.resize(total);
  rays.gain.resize(total);
  const bool is_straight = tunnel.settings().orientation_rad == 0.0;
  rays.pattern_mm.resize(is_straight ? 0 : total);
  std::vector<float> scratch(static_cast<std::size_t>(kBlock));
  for (std::int64_t pixel = 0; pixel < pixels; pixel += kBlock) {
    const int count = block_size(pixel, pixels);
    for (std::int64_t sample = 0; sample < cache.samples; ++sample) {
      const std::int64_t begin = sample * pixels + pixel;
      float* pattern = is_straight ? scratch.data() : rays.pattern_mm.data() + begin;
      float* gain = rays.gain.data() + begin;
      tunnel.hit_block(cache.block(begin, count), rays.x_mm.data() + begin, pattern, gain);
      multiply_gains(cache.weight.data() + begin, count, gain);
    }
  }
  const OccludedPixels occluded = occluded_pixels(cache, tunnel, camera_in_world_mm);
  hide_rays(occluded, tunnel.settings(), cache, rays.gain);
  if (!tunnel.dark().is_even()) {
    rays.shine = shine_of(cache, tunnel, rays.gain);
  }
  rays.hidden_share = hidden_share(occluded, tunnel.settings(), cache);
  return rays;
}

void render_frames(const RayCache& cache,
                   const WallRays& rays,
                   std::span<const StripePattern> patterns,
                   std::span<ImageF> frames) {
  GLINT_CHECK(patterns.size() == frames.size(), "a picture for each position");
  const std::int64_t pixels = cache.num_pixels();
  for (ImageF& frame : frames) {
    if (frame.width() != cache.width_px || frame.height() != cache.height_px) {
      frame = ImageF(cache.width_px, cache.height_px);
    }
  }
  const std::vector<float>& pattern_mm = rays.pattern_mm.empty() ? rays.x_mm : rays.pattern_mm;
  const float share = 1.0F / static_cast<float>(cache.samples);
  for (std::int64_t pixel = 0; pixel < pixels; pixel += kBlockOfFrames) {
    const int count = static_cast<int>(std::min<std::int64_t>(kBlockOfFrames, pixels - pixel));
    for (std::size_t k = 0; k < frames.size(); ++k) {
      float* out = frames[k].values().data() + pixel;
      std::fill_n(out, count, 0.0F);
      for (std::int64_t sample = 0; sample < cache.samples; ++sample) {
        const std::int64_t begin = sample * pixels + pixel;
        if (!rays.shine.empty()) {
          add_shining_stripes(
              rays, begin, pattern_mm.data() + begin, count, patterns[k], share, out);
          continue;
        }
        add_stripes(rays.x_mm.data() + begin,
                    pattern_mm.data() + begin,
                    rays.gain.data() + begin,
                    count,
                    patterns[k],
                    share,
                    out);
      }
    }
  }
}

void render_frame(const RayCache& cache,
                  const WallRays& rays,
                  const StripePattern& pattern,
                  ImageF& radiance) {
  render_frames(cache, rays, {&pattern, 1}, {&radiance, 1});
}

ScanResult take_scan(const RayCache& cache,
                     const Tunnel& tunnel,
                     const Sensor& sensor,
                     const ScanSettings& scan,
                     const Eigen::Vector3d& camera_in_world_mm,
                     const FrameConsumer& consume) {
  const WallRays rays = intersect_wall(cache, tunnel, camera_in_world_mm);
  const double step_mm = scan_step_mm(scan, tunnel.settings());
  ScanResult result;
  result.sums = ScanSums(cache.width_px, cache.height_px);
  std::vector<StripePattern> patterns;
  for (int k = 0; k < scan.positions; ++k) {
    patterns.push_back(tunnel.pattern(k * step_mm));
  }
  std::vector<ImageF> radiance(std::min(kFramesAtOnce, patterns.size()));
  ImageF grey;
  for (std::size_t first = 0; first < patterns.size(); first += kFramesAtOnce) {
    const std::size_t count = std::min(kFramesAtOnce, patterns.size() - first);
    render_frames(cache, rays, {patterns.data() + first, count}, {radiance.data(), count});
    for (std::size_t i = 0; i < count; ++i) {
      const int index = static_cast<int>(first + i);
      sensor.accumulate(radiance[i], index, result.sums, consume ? &grey : nullptr);
      if (consume) {
        consume(index, grey);
      }
    }
  }
  result.aspect = result.sums.aspect();
  result.hidden_share = rays.hidden_share;
  return result;
}

}  // namespace glint

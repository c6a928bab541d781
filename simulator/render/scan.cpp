// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

/// Rays that are worked on together: their arrays stay in the first caches.
constexpr std::int64_t kBlock = 4096;

void multiply_gains(const float* __restrict weight,
                    const float* __restrict seen,
                    int count,
                    float* __restrict gain) {
  for (int i = 0; i < count; ++i) {
    gain[i] *= weight[i] * seen[i];
  }
}

int block_size(std::int64_t begin, std::int64_t count) {
  return static_cast<int>(std::min(kBlock, count - begin));
}

}  // namespace

void visit_keys(KeyVisitor& keys, ScanSettings& s) {
  keys.integer("positions", s.positions, Range::between(1, 4096), "pictures in a scan");
  keys.number("step_mm",
              s.step_mm,
              Range::at_least(0),
              "between two positions; 0 = one period over all positions");
}

double scan_step_mm(const ScanSettings& scan, const TunnelSettings& tunnel) {
  if (scan.step_mm > 0.0) {
    return scan.step_mm;
  }
  // Oblique stripes move along their normal by the cosine only.
  const double cosine = std::cos(tunnel.orientation_rad);
  constexpr double kSmallestCosine = 0.01;
  if (cosine < kSmallestCosine) {
    throw ConfigError(
        "scan.step_mm: must be given: stripes that run along the tunnel do not move with it, so a "
        "period takes no number of steps");
  }
  return tunnel.period_mm / (scan.positions * cosine);
}

WallRays meet_wall(const RayCache& cache,
                   const Tunnel& tunnel,
                   const Eigen::Vector3d& camera_in_world_mm) {
  const std::int64_t pixels = cache.num_pixels();
  const std::size_t total = cache.weight.size();
  WallRays rays;
  rays.x_mm.resize(total);
  rays.gain.resize(total);
  const bool is_straight = tunnel.settings().orientation_rad == 0.0;
  rays.pattern_mm.resize(is_straight ? 0 : total);
  rays.hidden = Image<unsigned char>(cache.width_px, cache.height_px);
  std::vector<float> scratch(static_cast<std::size_t>(kBlock));
  std::vector<float> hidden(static_cast<std::size_t>(kBlock));
  for (std::int64_t pixel = 0; pixel < pixels; pixel += kBlock) {
    const int count = block_size(pixel, pixels);
    tunnel.hidden_block(cache.seen_block(pixel, count), camera_in_world_mm, hidden.data());
    for (int i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(pixel + i);
      const bool is_hidden =
          hidden[static_cast<std::size_t>(i)] > 0.0F && cache.coverage.values()[at] > 0.0F;
      hidden[static_cast<std::size_t>(i)] = is_hidden ? 0.0F : 1.0F;
      rays.hidden.values()[at] = is_hidden ? 1 : 0;
    }
    for (std::int64_t sample = 0; sample < cache.samples; ++sample) {
      const std::int64_t begin = sample * pixels + pixel;
      float* pattern = is_straight ? scratch.data() : rays.pattern_mm.data() + begin;
      float* gain = rays.gain.data() + begin;
      tunnel.hit_block(cache.block(begin, count), rays.x_mm.data() + begin, pattern, gain);
      multiply_gains(cache.weight.data() + begin, hidden.data(), count, gain);
    }
  }
  return rays;
}

void render_frame(const RayCache& cache,
                  const WallRays& rays,
                  const StripePattern& pattern,
                  ImageF& radiance) {
  const std::int64_t pixels = cache.num_pixels();
  if (radiance.width() != cache.width_px || radiance.height() != cache.height_px) {
    radiance = ImageF(cache.width_px, cache.height_px);
  }
  std::fill(radiance.values().begin(), radiance.values().end(), 0.0F);
  const std::vector<float>& pattern_mm = rays.pattern_mm.empty() ? rays.x_mm : rays.pattern_mm;
  const float share = 1.0F / static_cast<float>(cache.samples);
  for (std::int64_t pixel = 0; pixel < pixels; pixel += kBlock) {
    const int count = block_size(pixel, pixels);
    for (std::int64_t sample = 0; sample < cache.samples; ++sample) {
      const std::int64_t begin = sample * pixels + pixel;
      add_stripes(rays.x_mm.data() + begin,
                  pattern_mm.data() + begin,
                  rays.gain.data() + begin,
                  count,
                  pattern,
                  share,
                  radiance.values().data() + pixel);
    }
  }
}

ScanResult take_scan(const RayCache& cache,
                     const Tunnel& tunnel,
                     const Sensor& sensor,
                     const ScanSettings& scan,
                     const Eigen::Vector3d& camera_in_world_mm,
                     const FrameConsumer& consume) {
  const WallRays rays = meet_wall(cache, tunnel, camera_in_world_mm);
  const double step_mm = scan_step_mm(scan, tunnel.settings());
  ScanResult result;
  result.sums = ScanSums(cache.width_px, cache.height_px);
  ImageF radiance;
  ImageF grey;
  for (int k = 0; k < scan.positions; ++k) {
    render_frame(cache, rays, tunnel.pattern(k * step_mm), radiance);
    sensor.accumulate(radiance, k, result.sums, consume ? &grey : nullptr);
    if (consume) {
      consume(k, grey);
    }
  }
  result.aspect = result.sums.aspect();
  std::int64_t hidden = 0;
  std::int64_t on_part = 0;
  for (std::size_t i = 0; i < rays.hidden.size(); ++i) {
    hidden += rays.hidden.values()[i];
    on_part += cache.coverage.values()[i] > 0.0F ? 1 : 0;
  }
  result.hidden_share =
      static_cast<double>(hidden) / static_cast<double>(std::max<std::int64_t>(1, on_part));
  return result;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/blurred/blurred_pixels.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>

#include "simulator/render/blurred/lobe_picture.h"
#include "simulator/render/footprint/visible_part.h"
#include "simulator/render/scan/hidden_rays.h"
#include "simulator/render/wall/occluded_pixels.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kBlock = 4096;

/// Phases of the stripes where mirrored rays meet the wall, which runs on across the slot and below
/// its rims; not a number where not even that is met.
std::vector<float> phases_of(const RayCache& cache, const Tunnel& tunnel) {
  const bool is_straight = tunnel.settings().orientation_rad == 0.0;
  const auto total = static_cast<std::int64_t>(cache.weight.size());
  std::vector<float> phase_mm(cache.weight.size());
  std::vector<float> y(static_cast<std::size_t>(kBlock)), margin(y), x(y), cosine(y);
  for (std::int64_t begin = 0; begin < total; begin += kBlock) {
    const int count = static_cast<int>(std::min(kBlock, total - begin));
    const RayBlock rays = cache.block(begin, count);
    float* const phase = phase_mm.data() + begin;
    tunnel.intersect_block(rays, x.data(), y.data(), margin.data());
    if (is_straight) {
      std::copy_n(x.data(), count, phase);
    } else {
      tunnel.hit_details(rays, x.data(), y.data(), margin.data(), phase, cosine.data());
    }
    for (int i = 0; i < count; ++i) {
      if (margin[static_cast<std::size_t>(i)] == kNoHitMargin_mm) {
        phase[i] = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
  return phase_mm;
}

/// Of the lobes of some rays all over the picture, along the stripes' normal on the wall.
double narrowest_lobe_mm(const RayCache& cache,
                         const Tunnel& tunnel,
                         double alpha,
                         const Vector3d& camera_mm) {
  constexpr std::size_t kProbes = 500;
  const double turn = tunnel.settings().orientation_rad;
  double narrowest = std::numeric_limits<double>::infinity();
  const std::size_t step = std::max<std::size_t>(1, cache.weight.size() / kProbes);
  for (std::size_t ray = 0; ray < cache.weight.size(); ray += step) {
    if (cache.weight[ray] == 0.0F) {
      continue;
    }
    const RayBlock block = cache.block(static_cast<std::int64_t>(ray), 1);
    const Vector3d origin(static_cast<double>(*block.origin_x),
                          static_cast<double>(*block.origin_y),
                          static_cast<double>(*block.origin_z));
    const Vector3d mirrored(static_cast<double>(*block.direction_x),
                            static_cast<double>(*block.direction_y),
                            static_cast<double>(*block.direction_z));
    float t = 0.0F, x = 0.0F, gain = 0.0F;
    tunnel.cross_wall(block, &t, &x, &gain);
    if (gain == 0.0F) {
      continue;
    }
    const LobeShape shape = lobe_shape({.point_mm = origin,
                                        .to_viewer = (camera_mm - origin).normalized(),
                                        .mirrored = mirrored.normalized()},
                                       alpha);
    const double distance_mm = static_cast<double>(t) * std::hypot(mirrored.y(), mirrored.z());
    narrowest = std::min(
        narrowest, shape.width_along(distance_mm * std::sin(turn), distance_mm * std::cos(turn)));
  }
  return narrowest;
}

/// What the wall leaves of each ray's square of its pixel, by area; 0 where no part is met.
std::vector<float> visible_shares(const RayCache& cache,
                                  const OccludedPixels& occluded,
                                  const TunnelSettings& tunnel) {
  std::vector<float> share(cache.weight.size());
  std::ranges::transform(
      cache.weight, share.begin(), [](float weight) { return weight > 0.0F ? 1.0F : 0.0F; });
  hide_rays(occluded, tunnel, cache, share);
  const auto pixels = static_cast<std::size_t>(cache.num_pixels());
  const auto samples = static_cast<std::size_t>(cache.samples);
  const auto per_axis = static_cast<std::size_t>(std::lround(std::sqrt(cache.samples)));
  const double side = 1.0 / static_cast<double>(per_axis);
  for (const OccludedEdge& edge : occluded.edges) {
    const VisiblePart visible(edge, tunnel);
    for (std::size_t sample = 0; sample < samples; ++sample) {
      const std::size_t ray = sample * pixels + static_cast<std::size_t>(edge.pixel);
      const std::size_t row = sample / per_axis;
      const double x = (static_cast<double>(sample % per_axis) + 0.5) * side - 0.5;
      const double y = (static_cast<double>(row) + 0.5) * side - 0.5;
      const double area = visible.area({.x = x, .y = y, .side = side});
      share[ray] = cache.weight[ray] > 0.0F ? static_cast<float>(area) : 0.0F;
    }
  }
  return share;
}

/// @return points at which directions were summed
std::int64_t fill_bands(const LobeTask& task, ThreadPool* pool, BlurredPixels& pixels) {
  std::vector<std::int64_t> points(static_cast<std::size_t>(num_bands(task.cache)));
  const auto fill = [&](std::int64_t band) {
    points[static_cast<std::size_t>(band)] = fill_band(task, static_cast<int>(band), pixels);
  };
  if (pool != nullptr) {
    pool->for_each(std::ssize(points), fill);
  } else {
    for (std::int64_t band = 0; band < std::ssize(points); ++band) {
      fill(band);
    }
  }
  return std::accumulate(points.begin(), points.end(), std::int64_t{0});
}

}  // namespace

BlurredPixels blurred_pixels(const RayCache& cache,
                             const Tunnel& tunnel,
                             const ConductorNumbers& metal,
                             const ScanSettings& scan,
                             const Vector3d& camera_in_world_mm,
                             ThreadPool* pool) {
  const TunnelSettings& settings = tunnel.settings();
  const auto alpha = static_cast<double>(metal.alpha_x);
  BlurredPixels pixels;
  pixels.even = ImageF(cache.width_px, cache.height_px);
  const double narrowest = narrowest_lobe_mm(cache, tunnel, alpha, camera_in_world_mm);
  if (std::isfinite(narrowest)) {
    pixels.harmonics = harmonics_for(settings, narrowest);
  }
  const auto count = static_cast<std::size_t>(pixels.harmonics.count);
  pixels.real.assign(count, pixels.even);
  pixels.imaginary.assign(count, pixels.even);
  const OccludedPixels occluded = occluded_pixels(cache, tunnel, camera_in_world_mm);
  const std::vector<float> gain = visible_shares(cache, occluded, settings);
  pixels.hidden_share = hidden_share(occluded, settings, cache);
  const double middle_x_mm = 0.5 * (scan.positions - 1) * scan_step_mm(scan, settings);
  const StripeResponse response(tunnel, metal, middle_x_mm, pixels.harmonics);
  const std::vector<float> phase_mm = phases_of(cache, tunnel);
  const LobeTask task = {.cache = cache,
                         .response = response,
                         .tunnel = settings,
                         .phase_mm = phase_mm,
                         .gain = gain,
                         .camera_in_world_mm = camera_in_world_mm,
                         .alpha = alpha};
  pixels.points = fill_bands(task, pool, pixels);
  return pixels;
}

void render_blurred(const BlurredPixels& pixels,
                    const TunnelSettings& tunnel,
                    double shift_mm,
                    ImageF& radiance) {
  radiance = pixels.even;
  const double moved_mm = std::remainder(
      shift_mm * std::cos(tunnel.orientation_rad) + tunnel.offset_mm, tunnel.period_mm);
  const auto factors = wave_factors(pixels.harmonics, tunnel, moved_mm);
  for (std::size_t j = 0; j < factors.size(); ++j) {
    add_wave(pixels.real[j].values().data(),
             pixels.imaginary[j].values().data(),
             factors[j].real(),
             factors[j].imag(),
             static_cast<int>(radiance.size()),
             radiance.values().data());
  }
}

}  // namespace glint

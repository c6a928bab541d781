// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rough metal under a tunnel by its blurred reflections and by path tracing.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "simulator/render/blurred/blurred_pixels.h"
#include "simulator/render/path_tracing/packet_numbers.h"
#include "simulator/render/scan/hidden_rays.h"
#include "simulator/render/scan/scan.h"
#include "simulator/render/wall/occluded_pixels.h"
#include "tests/simulator/render/path_tracing/path_bench.h"

namespace glint::blurred_test {

using path_test::PathBench;

struct BlurredScene {
  PartSettings part;
  MaterialSettings metal;
  CameraSettings camera;
  Viewpoint viewpoint;
  TunnelSettings tunnel;
  ScanSettings scan;
  int rays_per_axis = 2;
};

inline TunnelLight light_of(const BlurredScene& scene) {
  return {.name = "tunnel",
          .settings = scene.tunnel,
          .positions = scene.scan.positions,
          .step_mm = scan_step_mm(scene.scan, scene.tunnel)};
}

inline PathBench bench_of(const BlurredScene& scene) {
  PathBench bench(build_part(scene.part), scene.metal, {}, scene.camera, scene.viewpoint);
  bench.lights = build_lights({}, {}, {}, light_of(scene));
  return bench;
}

inline RayCache rays_of(const BlurredScene& scene, const PathBench& bench) {
  ThreadPool pool(1);
  return trace_rays(bench.part,
                    bench.bvh,
                    bench.detail,
                    bench.camera,
                    bench.pose,
                    {.rays_per_axis = scene.rays_per_axis},
                    pool);
}

inline std::vector<ImageF> frames_of(const BlurredScene& scene, const BlurredPixels& pixels) {
  std::vector<ImageF> frames(static_cast<std::size_t>(scene.scan.positions));
  const double step_mm = scan_step_mm(scene.scan, scene.tunnel);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    render_blurred(pixels, scene.tunnel, static_cast<double>(k) * step_mm, frames[k]);
  }
  return frames;
}

inline BlurredPixels blurred_of(const BlurredScene& scene, const PathBench& bench) {
  const auto metal = conductor_numbers(bench.material.plain());
  return blurred_pixels(rays_of(scene, bench),
                        Tunnel(scene.tunnel),
                        metal.value(),
                        scene.scan,
                        inverse(bench.pose).translation_mm);
}

inline std::vector<ImageF> traced_frames(const BlurredScene& scene,
                                         const PathBench& bench,
                                         int samples,
                                         int seed) {
  const Film sums = bench.render({.samples = samples, .channels = 1, .seed = seed}, 2);
  std::vector<ImageF> frames;
  for (const auto& factors : tunnel_frame_factors(light_of(scene))) {
    frames.push_back(total_image(sums, factors, 0));
  }
  return frames;
}

/// Pixels that see the part alone and not past the wall's edge, and so do their neighbours.
inline Mask inner_pixels(const BlurredScene& scene, const PathBench& bench) {
  const ImageF sound = coverage_images(bench.render({.samples = 16, .has_light = false})).sound;
  const RayCache rays = rays_of(scene, bench);
  std::vector<float> gain(rays.weight.size(), 1.0F);
  const Tunnel tunnel(scene.tunnel);
  hide_rays(
      occluded_pixels(rays, tunnel, inverse(bench.pose).translation_mm), scene.tunnel, rays, gain);
  const auto pixels = static_cast<std::size_t>(rays.num_pixels());
  for (std::size_t i = 0; i < gain.size(); ++i) {
    gain[i % pixels] = std::min(gain[i % pixels], gain[i]);
  }
  const auto is_whole = [&](int x, int y) {
    return sound(x, y) == 1.0F &&
           gain[static_cast<std::size_t>(y) * static_cast<std::size_t>(rays.width_px) +
                static_cast<std::size_t>(x)] == 1.0F;
  };
  Mask inner(sound.width(), sound.height());
  for (int y = 1; y + 1 < sound.height(); ++y) {
    for (int x = 1; x + 1 < sound.width(); ++x) {
      bool all = true;
      for (int i = 0; i < 9; ++i) {
        all = all && is_whole(x + i % 3 - 1, y + i / 3 - 1);
      }
      inner(x, y) = all ? 1 : 0;
    }
  }
  return inner;
}

/// The error of frames against two independent noisy pictures of the same.
struct BlurredError {
  double rms = 0.0;         ///< noise taken out; 0 where it would be negative
  double percentile = 0.0;  ///< 99th of the distance from the mean of both, noise taken out
  double noise = 0.0;       ///< standard error of that mean
  double mean = 0.0;        ///< of the difference
  double contrast = 0.0;    ///< rms of the frames about their mean
  std::size_t values = 0;
};

/// The 99th.
inline double percentile_of(std::vector<double>& distances) {
  const auto rank = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(distances.size()));
  std::nth_element(distances.begin(), distances.begin() + rank, distances.end());
  return distances[static_cast<std::size_t>(rank)];
}

/// Half the difference of two pictures is as noisy as their mean: its percentile is what the mean's
/// noise alone would be off by. Both percentiles are subtracted as squares, as they add where
/// errors and noise are normal.
inline double without_noise(double percentile, double of_noise) {
  return std::sqrt(std::max(0.0, percentile * percentile - of_noise * of_noise));
}

inline BlurredError error_of(const std::vector<ImageF>& frames,
                             const std::vector<ImageF>& a,
                             const std::vector<ImageF>& b,
                             const Mask& where) {
  double product = 0.0, noise = 0.0, sum = 0.0, squares = 0.0, off = 0.0;
  std::vector<double> distances, noises;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (std::size_t i = 0; i < where.size(); ++i) {
      if (where.values()[i] == 0) {
        continue;
      }
      const auto value = static_cast<double>(frames[k].values()[i]);
      const auto first = static_cast<double>(a[k].values()[i]);
      const auto second = static_cast<double>(b[k].values()[i]);
      product += (value - first) * (value - second);
      noise += 0.25 * (first - second) * (first - second);
      off += value - 0.5 * (first + second);
      sum += value;
      squares += value * value;
      distances.push_back(std::abs(value - 0.5 * (first + second)));
      noises.push_back(0.5 * std::abs(first - second));
    }
  }
  const auto count = static_cast<double>(distances.size());
  return {.rms = std::sqrt(std::max(0.0, product / count)),
          .percentile = without_noise(percentile_of(distances), percentile_of(noises)),
          .noise = std::sqrt(noise / count),
          .mean = off / count,
          .contrast = std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count))),
          .values = distances.size()};
}

}  // namespace glint::blurred_test

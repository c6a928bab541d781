// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures in direct light by sums and by path tracing.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "simulator/render/direct/render_direct.h"
#include "tests/simulator/render/path_tracing/path_bench.h"

namespace glint::direct_test {

using path_test::PathBench;

inline PathSettings path_settings(int samples, int seed = 1) {
  return {.samples = samples, .max_reflections = 1, .channels = 1, .seed = seed};
}

inline Film direct_film(const PathBench& bench,
                        const DirectSettings& direct = {},
                        int threads = 1,
                        DirectCounts* counts = nullptr) {
  ThreadPool pool(threads);
  return render_direct(bench.scene(), path_settings(4), direct, pool, counts);
}

inline ImageF direct_picture(const PathBench& bench,
                             const DirectSettings& direct = {},
                             DirectCounts* counts = nullptr) {
  return total_image(direct_film(bench, direct, 1, counts), group_factors(bench.lights), 0);
}

inline ImageF traced_picture(const PathBench& bench, int samples, int seed) {
  return bench.picture(path_settings(samples, seed), 2);
}

/// A camera at some distance that looks at a point from an angle off the vertical.
inline Viewpoint view_from(double incidence_rad, double azimuth_rad, double distance_mm) {
  const double x = std::sin(incidence_rad) * std::cos(azimuth_rad);
  const double y = std::sin(incidence_rad) * std::sin(azimuth_rad);
  const double z = std::cos(incidence_rad);
  return {.position_mm = {distance_mm * x, distance_mm * y, distance_mm * z},
          .direction = {-x, -y, -z},
          .up = {-std::sin(azimuth_rad), std::cos(azimuth_rad), 0.0}};
}

/// The error of a picture against two independent noisy ones of the same.
struct PictureError {
  double mean = 0.0;        ///< of the difference, as a share of the mean
  double mean_noise = 0.0;  ///< standard error of that
  double rms = 0.0;         ///< noise taken out; 0 where it would be negative
  double percentile = 0.0;  ///< 95th of the distance from the mean of both, noise and all
  double noise = 0.0;       ///< standard error of a pixel of that mean
  double full_scale = 0.0;  ///< 99th percentile of the picture
};

inline double percentile_of(std::vector<double> values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

inline PictureError error_of(const ImageF& picture, const ImageF& a, const ImageF& b) {
  double product = 0.0, noise = 0.0, sum = 0.0, off = 0.0;
  std::vector<double> distances, values;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const auto value = static_cast<double>(picture.values()[i]);
    const auto first = static_cast<double>(a.values()[i]);
    const auto second = static_cast<double>(b.values()[i]);
    product += (value - first) * (value - second);
    noise += 0.25 * (first - second) * (first - second);
    off += value - 0.5 * (first + second);
    sum += 0.5 * (first + second);
    distances.push_back(std::abs(value - 0.5 * (first + second)));
    values.push_back(value);
  }
  const auto count = static_cast<double>(picture.size());
  return {.mean = off / sum,
          .mean_noise = std::sqrt(noise) / sum,
          .rms = std::sqrt(std::max(0.0, product / count)),
          .percentile = percentile_of(distances, 0.95),
          .noise = std::sqrt(noise / count),
          .full_scale = percentile_of(values, 0.99)};
}

}  // namespace glint::direct_test

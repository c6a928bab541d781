// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/direct/direct_film.h"

#include <algorithm>
#include <cmath>

namespace glint {

int brightness_octave(const SensorSettings& sensor, std::span<const std::vector<Colour>> frames) {
  double brightest = 0.0;
  for (const std::vector<Colour>& factors : frames) {
    for (const Colour& factor : factors) {
      brightest = std::max(brightest, static_cast<double>(factor.maxCoeff()));
    }
  }
  const double brightness = sensor.exposure * sensor.gain * brightest;
  constexpr double kMax = 30.0;
  return brightness > 1.0 ? static_cast<int>(std::min(kMax, std::ceil(std::log2(brightness)))) : 0;
}

DirectSettings direct_settings(const RenderSettings& render, int octave) {
  DirectSettings direct;
  const double finer = static_cast<double>(render.rays_per_axis) / direct.rays_per_axis;
  const double scale = std::ldexp(1.0, -octave);
  direct.tolerance *= scale / (finer * finer);
  direct.interpolated *= scale / (finer * finer);
  direct.spread *= scale / finer;
  direct.rays_per_axis = render.rays_per_axis;
  direct.max_rays_per_axis = 4 * render.rays_per_axis;
  return direct;
}

Film direct_film(const PhysicalScene& scene,
                 PathSettings settings,
                 const DirectSettings& direct,
                 ThreadPool& pool,
                 const PathPreview& preview) {
  constexpr int kMaskSamples = 16;
  settings.relative_error = 0.0;
  if (!settings.has_light) {
    return render_paths(scene, settings, pool, preview);
  }
  settings.samples = std::min(settings.samples, kMaskSamples);
  DirectCounts counts;
  Film film = render_direct(scene, settings, direct, pool, &counts);
  film.counts.camera += counts.rays;
  if (preview) {
    preview({.pass = 1, .samples = settings.samples, .sums = &film});
  }
  return film;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of the sums over paths at given factors of the light groups.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "simulator/light/area/lights.h"
#include "simulator/render/path_tracing/film.h"

namespace glint {

/// Factors of the scene's light groups, for total_image().
inline std::vector<double> group_factors(const Lights& lights) {
  std::vector<double> factors;
  for (const LightGroup& group : lights.groups) {
    factors.push_back(group.factor);
  }
  return factors;
}

/// The picture for any factors, one for each group: their weighted sum.
inline ImageF total_image(const Film& sums, std::span<const double> factors, int channel) {
  ImageF image(sums.width_px, sums.height_px);
  for (std::size_t i = 0; i < image.size(); ++i) {
    double total = 0.0;
    for (std::size_t g = 0; g < sums.groups.size(); ++g) {
      const ImageF& group = sums.groups[g].channels[static_cast<std::size_t>(channel)];
      total += factors[g] * static_cast<double>(group.values()[i]);
    }
    image.values()[i] = static_cast<float>(total / std::max(1, sums.samples.values()[i]));
  }
  return image;
}

}  // namespace glint

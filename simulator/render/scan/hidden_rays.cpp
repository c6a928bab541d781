// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reference (`sampled`) sees the same boundary of the slot as the footprints do: whole pixels
// behind the wall lose all of their rays, pixels on its edge those whose place in the pixel lies on
// the hidden side of the edge's line. docs/theory/footprints.md, "What the wall hides".
#include "simulator/render/scan/hidden_rays.h"

#include <cmath>

namespace glint {

void hide_rays(const OccludedPixels& occluded,
               const TunnelSettings& tunnel,
               const RayCache& cache,
               std::span<float> gain) {
  const auto pixels = static_cast<std::size_t>(cache.num_pixels());
  const auto samples = static_cast<std::size_t>(cache.samples);
  for (std::size_t i = 0; i < occluded.whole.size(); ++i) {
    for (std::size_t sample = 0; sample < samples && occluded.whole.values()[i] != 0; ++sample) {
      gain[sample * pixels + i] = 0.0F;
    }
  }
  const auto per_axis = static_cast<std::size_t>(std::lround(std::sqrt(cache.samples)));
  const auto place = [&](std::size_t index) {
    return (static_cast<double>(index) + 0.5) / static_cast<double>(per_axis) - 0.5;
  };
  for (const OccludedEdge& edge : occluded.edges) {
    const VisiblePart visible(edge, tunnel);
    for (std::size_t sample = 0; sample < samples; ++sample) {
      if (!visible.contains(place(sample % per_axis), place(sample / per_axis))) {
        gain[sample * pixels + static_cast<std::size_t>(edge.pixel)] = 0.0F;
      }
    }
  }
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light of every pixel's rays: summed at nodes, interpolated between them.
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/render/blurred/blurred_pixels.h"

namespace glint {

/// What the pixels of a picture are made of. Refers to what outlives it.
struct LobeTask {
  const RayCache& cache;
  const StripeResponse& response;
  const TunnelSettings& tunnel;
  const std::vector<float>& phase_mm;  ///< of each ray on the wall; not a number: meets none
  const std::vector<float>& gain;      ///< of each ray: what the wall leaves of it
  Eigen::Vector3d camera_in_world_mm;
  double alpha = 0.1;
};

/// Rows of the picture that share their nodes, so that each band may have its own thread.
int num_bands(const RayCache& cache);

/// Adds the rays of a band to its pixels. @return points at which directions were summed
std::int64_t fill_band(const LobeTask& task, int band, BlurredPixels& pixels);

}  // namespace glint

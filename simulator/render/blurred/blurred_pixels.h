// SPDX-License-Identifier: GPL-3.0-or-later
//
// What every pixel shows of a rough metal part at every position of the stripes, from kept rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/thread_pool.h"
#include "simulator/light/tunnel/scan_settings.h"
#include "simulator/render/blurred/stripe_response.h"
#include "simulator/render/ray_cache/ray_cache.h"

namespace glint {

/// The Fourier series of each pixel's radiance over the shift of the stripes.
struct BlurredPixels {
  HarmonicList harmonics;
  ImageF even;                          ///< mean over all shifts
  std::vector<ImageF> real, imaginary;  ///< of each harmonic
  double hidden_share = 0.0;  ///< of the part's pixels, hidden from the camera by the wall
  std::int64_t points = 0;    ///< at which directions were summed
};

/// Rays are those of the part's mirror directions: RayCache of a part that hides nothing of the
/// light from itself. The rays of a pixel are averaged, each with its own phase of the stripes; the
/// lobe around it is summed at every eighth pixel and interpolated to second order between, or
/// nearer where that does not do.
/// @param alpha of the metal is the same along and across; the first wavelength counts
/// @param scan  the wall's ends stand where they are in its middle
/// @param pool  nullptr: one thread. The same bytes for any number of them
/// @throws ConfigError as harmonics_for()
BlurredPixels blurred_pixels(const RayCache& cache,
                             const Tunnel& tunnel,
                             const ConductorNumbers& metal,
                             const ScanSettings& scan,
                             const Eigen::Vector3d& camera_in_world_mm,
                             ThreadPool* pool = nullptr);

/// The picture with the tunnel moved by shift_mm along x.
/// @param radiance  resized when it has another size
void render_blurred(const BlurredPixels& pixels,
                    const TunnelSettings& tunnel,
                    double shift_mm,
                    ImageF& radiance);

}  // namespace glint

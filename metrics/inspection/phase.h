// SPDX-License-Identifier: GPL-3.0-or-later
//
// Phase shifting: where in the scan a pixel is brightest, from all frames at once. A pixel sees
// mean + amplitude cos(2 pi periods j / N - phase) in frame j of N; least squares over the frames,
// which for a whole number of periods are the sums of the textbooks. Own account, with harmonics of
// binary stripes: docs/theory/inspection_masks.md.
#pragma once

#include <span>

#include "core/image/image.h"
#include "core/thread_pool.h"

namespace glint {

struct PhaseMaps {
  ImageF mean;        ///< in shares of full scale
  ImageF modulation;  ///< amplitude / mean, >= 0; 0 where the mean is not positive
  ImageF phase_rad;   ///< in [-pi, pi]; 2 pi is one period of the stripes
};

/// @param frames   at least three of one size, in equal steps over `periods`
/// @param periods  > 0; that the sequence takes, the step after the last frame included
/// @throws ConfigError for fewer frames, other sizes, NaN, or when these steps do not tell the
/// mean,
///         sine and cosine apart (whole multiples of N / 2 periods, or a small share of one)
PhaseMaps phase_maps(std::span<const ImageF> frames, double periods, ThreadPool& pool);

/// Below this amplitude, in shares of full scale, a pixel has no phase.
inline constexpr float kMinAmplitude = 0.01F;

/// How far a pixel's phase is from its surroundings', in periods, in [-0.5, 0.5]. Times
/// period / (2 distance of the light) it is the slope, in rad, that the surroundings have not.
///
/// The surroundings are the Gaussian mean of the phasors amplitude (cos, sin), so nothing needs
/// unwrapping and dark pixels count little. A phase that grows evenly gives 0 where the window lies
/// wholly inside the mask; at the rim the window's middle is not the pixel: take half a kernel off.
/// @param mask       pixels outside count nowhere and give 0; so do those without a phase
/// @param kernel_px  odd, >= 3
/// @param sigma_px   >= 0; 0: 0.3 ((kernel_px - 1) / 2 - 1) + 0.8, as OpenCV has it
/// @throws ConfigError as phase_maps()
ImageF phase_response(std::span<const ImageF> frames,
                      double periods,
                      const Mask& mask,
                      int kernel_px,
                      double sigma_px,
                      ThreadPool& pool);

}  // namespace glint

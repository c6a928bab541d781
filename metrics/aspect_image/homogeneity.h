// SPDX-License-Identifier: GPL-3.0-or-later
//
// How even the flawless surface looks in the aspect image. Formulas and choices:
// docs/theory/homogeneity.md.
#pragma once

#include <cstdint>
#include <optional>

#include "core/image/image.h"
#include "core/image/spans.h"
#include "metrics/aspect_image/settings.h"

namespace glint {

/// Uniformity over a region. With mean mu, standard deviation sigma (over n, not n - 1) and
/// percentiles P5, P95 (nearest rank) of the region's pixels:
struct Homogeneity {
  double h_rms = 0.0;            ///< 1 - sigma / mu; <= 1, not clamped
  double h_abs = 0.0;            ///< 1 - mean |f - mu| / mu; >= h_rms
  std::optional<double> robust;  ///< 1 - (P95 - P5) / (P95 + P5); in [0, 1]; if it was asked for
  double mean = 0.0;             ///< mu
  double clipped_share = 0.0;    ///< pixels at full scale in every frame: no defect can show there
  double lit_share = 0.0;        ///< pixels above the lit threshold
};

/// Scores the aspect image over a region.
///
/// A black region has no uniformity; so that it can win against nothing, it gets h_rms = -sqrt(n)
/// and h_abs = -1, below every image of n pixels with any light (the worst, one lit pixel, has
/// 1 - sqrt(n - 1) and 2 / n - 1), and robust = 0.
///
/// @param aspect          mean of the frames, in [0, 1]
/// @param clipped_frames  frames in which each pixel is at full scale; empty: those with aspect 1
/// @param frames          number of frames behind clipped_frames
/// @param region          at least one pixel
/// @param wants_robust    percentiles cost as much as all else
Homogeneity homogeneity(const ImageF& aspect,
                        const Image<std::uint16_t>& clipped_frames,
                        int frames,
                        const Region& region,
                        const MetricsSettings& settings = {},
                        bool wants_robust = true);

/// U0 of lighting practice: the smallest mean of a 3 x 3 square (its pixels in the region) over the
/// mean of the region, in [0, 1]; 0 for a black region. Smoothed, because noise drives a minimum.
double smallest_over_mean(const ImageF& aspect, const Mask& region);

}  // namespace glint

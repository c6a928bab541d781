// SPDX-License-Identifier: GPL-3.0-or-later
//
// Further readings of how even the flawless surface is: at which scale, where, and whether the
// stripes show in it. Formulas and choices: docs/theory/homogeneity.md.
#pragma once

#include <cstdint>
#include <optional>

#include "core/image/image.h"
#include "metrics/aspect_image/settings.h"

namespace glint {

/// What is fine and what is coarse in a picture.
struct FamilyScales {
  double defect_diameter_px = 20.0;  ///< > 0
  double period_px = 0.0;            ///< of the stripes along the rows; 0: not known
};

struct HomogeneityFamily {
  double u0 = 0.0;               ///< smallest 3 x 3 mean over the mean; in [0, 1]
  double residual = 0.0;         ///< 1 - std(f / g) / mean(f / g), g the shading; <= 1
  double low_share = 0.0;        ///< of the variance, slower than the cut; in [0, 1]
  double high_share = 0.0;       ///< 1 - low_share
  double worst_region = 0.0;     ///< smallest h_rms of any tile; <= 1
  std::optional<double> ripple;  ///< amplitude at the stripes' harmonics over the mean; >= 0
};

/// A few passes over the picture for each; some 0.1 s for 1300 x 300 pixels in all.
///
/// A black region gets u0 = 0 and, like h_rms, residual = worst_region = -sqrt(n).
/// @param aspect  mean of the frames, in [0, 1]
/// @param region  at least one pixel
HomogeneityFamily homogeneity_family(const ImageF& aspect,
                                     const Mask& region,
                                     const FamilyScales& scales,
                                     const MetricsSettings& settings = {});

/// The mean around each pixel of the region, Gaussian-weighted, of the region's pixels only: a
/// Gaussian over f m divided by the same over m. Zero elsewhere.
/// @param sigma_px  > 0; four running means stand for the Gaussian, their variance is its own
ImageF shading_of(const ImageF& aspect, const Mask& region, double sigma_px);

/// Smallest h_rms of the tiles of a tiles x tiles grid over the region's box of which the region
/// fills a quarter or more; of the whole region when there is none. @param tiles  >= 1
double worst_region(const ImageF& aspect, const Mask& region, int tiles);

/// Root of the summed squared amplitudes at the harmonics (up to the eighth) of the stripes, along
/// the rows, over the mean. What lies midway between the harmonics (noise, shading) is taken off.
/// Empty when no run of region pixels holds four periods. @param period_px  >= 4
std::optional<double> fringe_ripple(const ImageF& aspect, const Mask& region, double period_px);

}  // namespace glint

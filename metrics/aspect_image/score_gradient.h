// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "metrics/aspect_image/defect_scores.h"

namespace glint {

/// What a score of an aspect image is taken from.
struct ScoredImage {
  const ImageF& aspect;
  const Mask& region;
  std::span<const DefectPixels> defects;
  double sigma_floor = 0.0;  ///< of defect_scores()
  const ImageF* deviation =
      nullptr;  ///< of the pixels' scatter, if it counts: with_noise_variance()
};

/// The share that scatter has in the square of what h_rms is 1 less; 0 without.
double noise_share(const ScoredImage& image);

/// Derivative of a score by each pixel of the aspect image: homogeneity.h_rms, h_abs and mean;
/// defects.min_cnr, min_weber, mean_weber and each defect's cnr and weber. Of a smallest or largest
/// one it is that of the defect at fault, of an absolute value that of the side it is on.
/// Empty for scores that have none: percentiles, counts, steps.
std::optional<ImageF> gradient_by_aspect(std::string_view score, const ScoredImage& image);

/// Whether gradient_by_aspect() knows it.
bool has_gradient(std::string_view score);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors of noisy pictures and scores against the mean of independent ones, without the noise that
// this mean has itself.
#pragma once

#include <span>
#include <vector>

#include "core/image/image.h"
#include "studies/frontier/frontier.h"
#include "studies/imaging/traced_scene.h"

namespace glint {

/// Mean squares of the differences of two sets of frames.
struct PictureDistance {
  double mean_square = 0.0;    ///< over all pixels that see the part
  double smooth_square = 0.0;  ///< over the region of interest
};

/// Independent pictures of a scene, frame by frame, of which the mean is the reference.
class ReferencePictures {
 public:
  /// @param frames  grey values, full scale 1
  void add(const TracedScene& traced, const std::vector<ImageF>& frames);

  /// Of the mean of all pictures, by their scatter; 0 for fewer than two.
  double own_square() const { return own_.mean_square; }

  double own_smooth_square() const { return own_.smooth_square; }

  double own_rmse() const;

  /// From other frames of the same scene to the mean, that mean's own noise included.
  /// @param reduction  1, or a power of two by which their pixels are larger
  PictureDistance distance(const std::vector<ImageF>& frames, int reduction) const;

 private:
  void update_own();

  int pictures_ = 0;
  std::vector<std::vector<double>> sums_;     ///< of each frame's pixels
  std::vector<std::vector<double>> squares_;  ///< the same of their squares
  ImageF coverage_;
  Mask region_;
  PictureDistance own_;
};

/// Of independent values against the reference: the root of their mean square distance, less the
/// reference's own noise. @param values  one or more
ScoreError score_error(std::span<const double> values, const ReferenceScore& reference);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Linear filters that see the pixels of a mask only: weighted sums of separable convolutions, with
// weights for each pixel that make up for what lies outside. docs/theory/inspection.md
#pragma once

#include <vector>

#include "core/image/image.h"
#include "core/thread_pool.h"
#include "metrics/inspection/inspection_settings.h"

namespace glint {

/// One side of a symmetric kernel, from the middle on; applied along rows and columns.
using HalfKernel = std::vector<float>;

/// sigma_px, or if that is 0 what OpenCV takes for such a kernel.
double gaussian_sigma(const InspectionSettings& settings);

/// A sampled Gaussian of sum 1. @param radius  taps to either side, >= 0
HalfKernel gaussian_kernel(double sigma_px, int radius);

class MaskedFilter {
 public:
  MaskedFilter() = default;

  /// The filter of the settings; not phase and structure, which have none.
  /// @param region  pixels of the mask that get a response
  MaskedFilter(const InspectionSettings& settings, const Mask& mask, const Mask& region);

  /// @param masked  0 outside the mask, of the mask's size
  /// @param result  of that size, becomes 0 outside the region; anything may be in it
  void respond(const ImageF& masked, ThreadPool& pool, ImageF& result) const;

  /// For each pixel, the sum of the kernel times the picture; beyond the picture is 0.
  static ImageF convolved(const ImageF& image, const HalfKernel& kernel);

  /// How much larger than a blur's the rounding errors of the response are, >= 1.
  double amplification() const { return amplification_; }

 private:
  struct Term {
    HalfKernel kernel;
    ImageF weights;  ///< 0 outside the region
  };

  /// own * picture + sum of weights * (kernel * picture)
  struct Channel {
    float own = 0.0F;
    std::vector<Term> terms;
  };

  struct Bounds {
    int begin = 0;
    int end = 0;
  };

  struct Rows;

  void add_gaussian(const ImageF& inside, const InspectionSettings& settings);
  void add_difference(const ImageF& inside, double sigma_px);
  void add_matched(const ImageF& inside, double diameter_px);
  void filter_row(Rows& rows, int y, float* out) const;

  double amplification_ = 1.0;
  Mask region_;
  std::vector<Bounds> bounds_;     ///< columns of a row that hold all of its region
  std::vector<Channel> channels_;  ///< the response is that of the largest size
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives of the stripes' integral over a part of a pixel
// (simulator/render/footprint/stripe_integral.h) by the phase and by the boundaries that cut it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "simulator/render/footprint/stripe_integral.h"

namespace glint {

/// What a linear function over a pixel changes.
struct LinearGradient {
  double value = 0.0;
  double dx = 0.0;
  double dy = 0.0;

  /// The derivatives by the four corners of linear_through().
  std::array<double, 4> by_corners() const;
};

/// What shines of the stripes.
struct StripeLevels {
  double duty = 0.5;
  double dark = 0.0;    ///< of the whole area
  double bright = 1.0;  ///< of the stripes, in addition
};

/// Derivative of a polygon's lit and bright area, summed over frames with weights w_k:
/// sum of w_k (dark * area + bright * share_k).
struct StripeGradient {
  static constexpr int kLabels = 15;  ///< that edges of polygons may have

  LinearGradient phase;
  std::array<LinearGradient, kLabels> boundary;  ///< by the function that clipped, for each label
  double duty = 0.0;
  double share = 0.0;  ///< sum of w_k * share_k
  double area = 0.0;   ///< sum of w_k * area

  /// @param boundaries  the functions that clipped, by their labels
  void add(const PixelPolygon& polygon,
           const LinearFunction& phase_of_pixel,
           std::span<const LinearFunction> boundaries,
           const std::vector<double>& shifts,
           const std::vector<double>& weights,
           const StripeLevels& levels);
};

}  // namespace glint

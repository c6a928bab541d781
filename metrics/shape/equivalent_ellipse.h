// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ellipse with the moments of a shape (first seed, section 2.2.2). Formulas, accuracy and
// undefined cases: docs/theory/inspection_masks.md.
#pragma once

#include <optional>

#include "core/image/image.h"

namespace glint {

/// Moments about the centre of mass, over the area, each pixel with its own extent (1/12 px2).
/// x to the right, y down; the centre of the first pixel is (0.5, 0.5).
struct ShapeMoments {
  double area_px = 0.0;  ///< > 0; sum of the weights
  double x_px = 0.0;
  double y_px = 0.0;
  double xx = 0.0;  ///< px2
  double xy = 0.0;
  double yy = 0.0;
  double xxx = 0.0;  ///< px3
  double xxy = 0.0;
  double xyy = 0.0;
  double yyy = 0.0;
};

/// @param weights  share of each pixel that the shape covers, >= 0
/// @returns nothing for an empty shape @throws ConfigError for NaN, infinity or negative weights
std::optional<ShapeMoments> moments_of(const ImageF& weights);
std::optional<ShapeMoments> moments_of(const Mask& mask);

struct EquivalentEllipse {
  double x_px = 0.0;
  double y_px = 0.0;
  double length_px = 0.0;  ///< whole axes, 4 sqrt(l1) and 4 sqrt(l2)
  double width_px = 0.0;
  double angle_rad = 0.0;   ///< of the long axis, in (-pi/2, pi/2]; +x to +y (down)
  double elongation = 0.0;  ///< (l1 - l2) / (l1 + l2): 0 a disc, 1 a line
  double skewness = 0.0;    ///< third moment along the long axis over l1^1.5
};

EquivalentEllipse ellipse_of(const ShapeMoments& moments);

/// 1 inside, 0 outside.
ImageF coverage_of(const Mask& mask);

}  // namespace glint

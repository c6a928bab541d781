// SPDX-License-Identifier: GPL-3.0-or-later
//
// Laying a reference mask onto a part by the moments of both (first seed, section 2.2.2). Formulas,
// accuracy and undefined cases: docs/theory/inspection_masks.md.
#pragma once

#include <optional>
#include <string_view>

#include "core/image/image.h"

namespace glint {

/// Turns about the reference's middle, scales, and moves it onto the part's middle.
struct Similarity {
  double from_x_px = 0.0;
  double from_y_px = 0.0;
  double to_x_px = 0.0;
  double to_y_px = 0.0;
  double angle_rad = 0.0;  ///< +x to +y (down)
  double scale = 1.0;      ///< > 0
};

/// What settled the rotation.
enum class RotationRule {
  kSkewness,      ///< the long axes, and which end is heavier
  kOverlap,       ///< the long axes, and the better overlap of two ends alike in weight
  kEitherWay,     ///< the long axes; turned by half a turn the outline fits as well
  kThirdMoments,  ///< no long axis; the third moments point somewhere
  kNone           ///< neither: the shape is round, only place and scale are known
};

/// What the user should know about it; empty when the rotation is sure.
std::string_view warning(RotationRule rule);

struct ShapeMatch {
  Similarity to_part;  ///< from the reference's picture to the part's
  RotationRule rule = RotationRule::kNone;
  double overlap = 0.0;  ///< intersection over union of the outlines, in [0, 1]; low: another part
};

/// Lays the outline of a reference onto the outline of a part of the same shape.
/// @param reference, part  coverage in [0, 1]; the pictures may differ in size
/// @returns nothing when one of them is empty
std::optional<ShapeMatch> match_shapes(const ImageF& reference, const ImageF& part);
std::optional<ShapeMatch> match_shapes(const Mask& reference, const Mask& part);

/// The reference as it lies in a picture of the part; 0 beyond the reference's own picture. Mean of
/// bilinear samples, enough of them for the scale.
ImageF warped(const ImageF& reference, const Similarity& to_part, int width_px, int height_px);

/// The same for a mask: pixels covered by half or more.
Mask warped(const Mask& reference, const Similarity& to_part, int width_px, int height_px);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Places of a picture that look like an inner corner of a checkerboard: saddles of brightness,
// around which a circle is twice dark and twice bright.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "core/image/image.h"

namespace glint {

/// A possible inner corner.
struct SaddlePoint {
  Eigen::Vector2d at_px = {0.0, 0.0};
  double contrast = 0.0;  ///< bright minus dark, grey values
  /// Directions of its four edges, unit vectors one after the other as angles from +x towards +y
  /// grow. Across edges 0 and 2 it becomes brighter in that sense, across 1 and 3 darker.
  std::array<Eigen::Vector2d, 4> edges;
};

/// The saddles of a picture, found after a blur of 1 px, strongest first; positions to about 0.1
/// px. Squares must be at least 8 px wide, and the picture's own blur should be below 3 px.
///
/// The strength is the negative determinant of the Hessian; maxima of it are kept that stand out
/// from the strongest ones, and whose circle of 5 or 3 px passes the test.
/// Cost: some 40 operations a pixel.
/// Source: D. Chen, G. Zhang, "A new sub-pixel detector for x-corners in camera calibration
/// targets", WSCG 2005 (the determinant); the circle as in S. Bennett, J. Lasenby, "ChESS - quick
/// and robust detection of chess-board features", CVIU 118, 2014.
/// @param most  no more than that many
std::vector<SaddlePoint> find_saddle_points(const ImageF& picture, int most);

}  // namespace glint

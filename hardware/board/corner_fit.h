// SPDX-License-Identifier: GPL-3.0-or-later
//
// The exact place of an inner corner: a model of two blurred edges fitted to the grey values around
// it, on the level of the picture and in the window that suit its blur and noise.
//
// Model: with d1, d2 the distances from two lines through the corner and E(d) = erf(d / (sqrt(2)
// s)),
//     grey = b + g . x + (c + h . x) E(d1) E(d2),
// x from the corner. Unknown: the corner, both lines' angles, the blur s, brightness b with its
// gradient g, half the contrast c with its gradient h. For edges that are not perpendicular the
// product is not exactly the blurred picture; but both look the same after half a turn about the
// corner, and so does the round window, so that the corner's place has no error from that.
// The blur's standard deviation includes the pixel's own, 0.29 px.
//
// Window: of an edge of length 2 r, blurred by s, whose grey values have a noise of n and a step of
// 2 c, the place is known to n sqrt(2 sqrt(pi) s / (2 r)) / (2 c) (Cramer-Rao; own derivation:
// the derivative across the edge squared has the integral (2 c)^2 / (2 sqrt(pi) s)). r is chosen to
// make that 0.018 px of the picture, but at most 12 px, at least 2.2 s + 1.5 px, and less than 0.42
// squares; all but squares in px of the level, of which one is taken on which s is 1 to 2.4 px.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "hardware/board/picture_levels.h"

namespace glint {

/// Where a corner is before the fit.
struct CornerGuess {
  Eigen::Vector2d at_px = {0.0, 0.0};    ///< to 2 px of the level it was found on
  Eigen::Vector2d rising = {1.0, 0.0};   ///< unit: it becomes brighter from +x to +y across it
  Eigen::Vector2d falling = {0.0, 1.0};  ///< unit: there it becomes darker
  double clearance_px = 0.0;             ///< to the next parallel edges
};

/// A fitted corner. Lengths in px of the picture, grey values from 0 to 1.
struct CornerFit {
  Eigen::Vector2d at_px = {0.0, 0.0};
  double blur_px = 0.0;        ///< standard deviation, with the pixel's own
  double contrast = 0.0;       ///< bright minus dark
  double noise = 0.0;          ///< root mean square of what the model leaves, of one pixel
  double clipped_share = 0.0;  ///< of the window
  double window_px = 0.0;      ///< its radius
};

/// The corner near a guess. Empty when the fit does not settle, leaves the guess by more than 0.4
/// of the clearance, or the corner is less than 3 px from the picture's border.
/// @param level  that the guess was found on
std::optional<CornerFit> fit_corner(PictureLevels& levels, int level, const CornerGuess& guess);

}  // namespace glint

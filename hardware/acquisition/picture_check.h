// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a picture is good enough to be kept: exposure, blur, the part in view. Figures first, so
// that a report can show them, and what limits say to them.
#pragma once

#include <optional>
#include <string>

#include "core/config/keys.h"
#include "core/image/image.h"
#include "hardware/camera/camera.h"

namespace glint {

/// Keys of [acquisition] in a cell file that say what is kept.
struct PictureLimits {
  double min_bright = 0.05;  ///< level that the brightest 0.5 % must reach, of the full range
  double max_clipped_share = 0.25;   ///< of all pixels, at the largest code
  double min_sharpness_share = 0.6;  ///< of the sharpest picture of its own sequence
  double min_sharpness = 0.0;        ///< see PictureFigures; 0: none
  double max_blur_px = 0.0;          ///< sigma of a single picture's edges; 0: blur_limit_px()
  double min_outline_share = 0.5;    ///< of the expected outline that must be seen
  int max_retakes = 2;               ///< of one picture
};

void visit_keys(KeyVisitor& keys, PictureLimits& limits);

struct PictureFigures {
  double mean = 0.0;           ///< of the full range, as all levels
  double bright = 0.0;         ///< level that 99.5 % of the pixels do not exceed
  double clipped_share = 0.0;  ///< of the pixels
  /// Mean square of the differences of neighbours in rows and columns, less what the noise makes of
  /// them, over the square of the mean level: falls with blur and shake, not with exposure. The
  /// noise is told by second differences in both directions (Immerkaer, CVIU 64, 1996), by their
  /// median, so that edges do not count.
  double sharpness = 0.0;
  double outline_share =
      1.0;  ///< of the expected outline that stands out; 1 where none is expected
  /// Sigma of the edges [px], along the outline where one is expected: edge_spread_px(). Empty: was
  /// not asked for, or there are too few edges.
  std::optional<double> edge_px = {};
};

/// What may be told of a picture before it is taken.
struct ExpectedPicture {
  /// True where the part should be, of the picture's size or of that divided by a whole number;
  /// empty: not known.
  Mask part = {};
  double tolerance_px = 0.0;  ///< how far the part may be shifted from there, in its own pixels
  double blur_px = 0.0;       ///< sigma of the edges as the camera sees them; 0: not known
};

/// How wide the edges of a single picture may be [px]: of the cell's limits, else twice what is
/// expected and half a pixel. 0: anything, as neither tells one.
double blur_limit_px(const PictureLimits& limits, double expected_blur_px);

/// @param frame       complete
/// @param has_spread  edge_px, too
PictureFigures figures_of(const Frame& frame,
                          const ExpectedPicture& expected = {},
                          bool has_spread = false);

/// Why a picture is not kept; empty: it is.
/// @param sharpest       of the pictures of its sequence so far; 0: it is the first
/// @param max_blur_px    blur_limit_px(); 0: none
std::string rejection_of(const PictureFigures& figures,
                         const PictureLimits& limits,
                         double sharpest,
                         double max_blur_px = 0.0);

}  // namespace glint

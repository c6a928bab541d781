// SPDX-License-Identifier: GPL-3.0-or-later
//
// How regular the projected stripes look in one frame, along the image rows (the scan direction).
// Each row is cut into runs of region pixels; in a run the edges are where the grey value crosses
// the middle between the run's darkest and brightest value, to a fraction of a pixel.
#pragma once

#include <optional>

#include "core/image/image.h"

namespace glint {

struct FringeSettings {
  double nominal_duty = 0.5;    ///< in (0, 1); bright share of the pattern
  double hysteresis = 0.2;      ///< in [0, 1); share of a run's span that an edge must travel
  double min_modulation = 0.1;  ///< runs with less carry no stripes
};

struct FringeScores {
  double regularity = 0.0;  ///< coefficient of variation of the spacing; 0 is regular
  double period_px = 0.0;   ///< mean spacing of edges of one direction
  double duty = 0.0;        ///< bright length over period
  double duty_error = 0.0;  ///< duty - nominal duty
  double modulation = 0.0;  ///< (max - min) / (max + min), mean over the runs with stripes
  int periods = 0;          ///< spacings that were measured
};

/// Measures all runs of a frame together. The spacing is that of successive edges of the same
/// direction (bright to bright), so that a duty other than one half is no irregularity.
/// Empty when no run has three edges.
std::optional<FringeScores> fringe_scores(const ImageF& frame,
                                          const Mask& region,
                                          const FringeSettings& settings = {});

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/config/keys.h"
#include "core/units.h"

namespace glint {

/// The [coverage] table of a scene: what it takes for a view to inspect a place of the surface.
struct CoverageSettings {
  enum class Choice { kGreedy, kExact };

  double max_incidence_rad = 60.0 * kRadPerDeg;  ///< between normal and view
  double max_pixel_mm = 0.0;   ///< of the surface in one pixel, the longer way; 0: any
  double max_blur_px = 1.0;    ///< diameter of the circle of confusion
  bool has_light = true;       ///< brightness counts; else geometry alone
  double min_grey = 0.02;      ///< mean of the frames; share of full scale
  double max_grey = 0.98;      ///< of the darkest frame: above, all are clipped
  double min_lit_share = 0.5;  ///< mirrors under a tunnel: of the scan's positions
  double separation_rad = 15.0 * kRadPerDeg;  ///< between views that count as two for Ck
  double defect_px = 3.0;                     ///< a defect must be this wide in the picture
  int points = 20000;                         ///< on the surface, about
  int seed = 1;                               ///< of where in their cells they lie
  int samples = 16;  ///< of each pixel of the picture that tells brightness
  int choose = 0;    ///< as many views as are to be chosen; 0: all are used
  Choice choice = Choice::kGreedy;
};

void visit_keys(KeyVisitor& keys, CoverageSettings& settings);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/config/keys.h"

namespace glint {

/// The [metrics] table of a scene: where and against what the scores are taken. Radii are those of
/// the defect in question.
struct MetricsSettings {
  int erosion_px = 2;               ///< >= 0; rim of the part left out of the region of interest
  double exclusion_radii = 2.0;     ///< >= 1; around each defect, left out of homogeneity
  double ring_inner_radii = 2.0;    ///< >= 1; the background of a defect begins here
  double ring_outer_radii = 5.0;    ///< > ring_inner_radii; and ends here
  double lit_threshold = 0.01;      ///< in [0, 1] of full scale; below, light does not reach
  double signature_sigmas = 3.0;    ///< > 0; deviation that counts as signature, in sigma_B ...
  double signature_floor = 0.02;    ///< >= 0; ... but no less than this share of full scale
  double defect_diameter_px = 0.0;  ///< >= 0; parts fine from coarse; 0: the scene's largest defect
  double shading_diameters = 3.0;   ///< >= 3; sigma of the shading, in those diameters
  int regions = 4;                  ///< >= 1; the worst is sought among so many times so many tiles
};

/// Names, ranges and cross checks of the keys.
void visit_keys(KeyVisitor& keys, MetricsSettings& settings);

}  // namespace glint

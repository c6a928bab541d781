// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cells that compare the program with itself: which of two designs is better, and what one method
// makes of a scene against the next one. These have no reference; a flip or a jump is their error.
#pragma once

#include "studies/stability/stability_cell.h"

namespace glint::stability {

/// Two tunnels that differ in radius; the first is compared undisturbed.
struct DesignPair {
  double h_first = 0.0;
  double h_second = 0.0;

  double lead_points() const { return 100.0 * (h_first - h_second); }
};

/// h of both designs. @throws ConfigError
DesignPair design_pair(SceneStore& store, const ConfigNode& root);

/// What of the undisturbed lead is turned round: 0 while the same design is better, else how far
/// the wrong one leads and the right one led, the smaller of the two.
CellError flip_error(const DesignPair& undisturbed,
                     const DesignPair& disturbed,
                     const Bounds& bounds);

/// h and mean image of one method against those of another, and of their defects the change that
/// differs most.
std::vector<CellError> errors_of_switch(const Outcome& outcome,
                                        const Outcome& other,
                                        const Bounds& bounds);

}  // namespace glint::stability

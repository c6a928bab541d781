// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many places on a piece of a light are enough for a point of metal, in float and free of
// Eigen.
#pragma once

#include "simulator/render/direct/emitter_places.h"

namespace glint {

/// What a point of metal is seen under.
struct PanelView {
  float viewer[3] = {0.0F, 0.0F, 1.0F};  ///< local, unit
  float side[3] = {0.0F, 0.0F, 1.0F};    ///< local: light from behind it is blocked
  float alpha_x = 0.1F;
  float alpha_y = 0.1F;
};

/// How smooth the light of a panel is. A Gauss-Legendre rule of n places along s errs by about
/// bound rho_s^(-2 n), rho_s the size of the Bernstein ellipse through the nearest pole.
struct PanelSmoothness {
  float bound = 0.0F;  ///< above what the panel can add to the radiance; 0: nothing
  float log2_rho_s = 0.0F;
  float log2_rho_t = 0.0F;
  bool is_cut = false;  ///< the horizon runs through it
};

PanelSmoothness smoothness_of(const LocalEmitter& emitter,
                              const PanelView& view,
                              const Panel& panel);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of shape_derivative.h, compiled for wide instruction sets as tunnel_kernels.h.
#pragma once

#include "simulator/light/tunnel/tunnel_kernels.h"

namespace glint {

/// What hits (Tunnel::intersect_block) change, ray by ray.
struct HitGradient {
  const float* x = nullptr;
  const float* y = nullptr;       ///< null: 0 for all rays ...
  const float* margin = nullptr;  ///< ... and this one too
};

/// Outward normals of a curved wall at nodes from one foot to the other over its top: one more than
/// pieces, half of them each side. With s from 0 at the top to 1 at a foot, evenly, a node's |y| to
/// z is as 2 s^2 to 1 - 2 s^2 in the upper half, and as the reverse for 1 - s in the lower one:
/// there a superellipse's normal and speeds go as powers, which straight lines follow badly.
struct WallNormals {
  const float* y = nullptr;
  const float* z = nullptr;
  int pieces = 0;  ///< 15 at least
};

/// Adds the derivatives by a shift of the wall along its normal, where rays meet it, to the nodes
/// on both sides. Rays without gradient add nothing, whatever they meet.
/// @param by_node  one more than pieces
void add_shift_derivatives(const RayBlock& rays,
                           const float* y_mm,
                           const float* margin_mm,
                           const HitGradient& derivatives,
                           const WallNormals& normals,
                           double* by_node);

/// In double, lane by lane: the same bits for any instruction set.
double sum_in_lanes(const float* values, int count);

}  // namespace glint

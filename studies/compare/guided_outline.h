// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part's outline in a real picture, looked for where the simulated one lies: what is bright
// there decides nothing, so edges of light within the part are no outline. Private to the room.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/image/image.h"
#include "metrics/overlap/boundary.h"

namespace glint::compare_detail {

/// The same outline in both pictures. Where one of them shows no edge along it both are broken.
struct GuidedOutlines {
  std::vector<Boundary> simulated_rough;  ///< as the renderer knows it
  std::vector<Boundary> simulated;        ///< located
  std::vector<Boundary> real_rough;       ///< the simulated one moved onto the real one as a whole
  std::vector<Boundary> real;             ///< located near that
  double share = 0.0;                     ///< of the simulated edges that the real picture has
};

/// The simulated outline is moved by shift, turn, scale and shear until most of the silhouette's
/// edges lie on it (nearest points, robustly), then edges of the same sign are located along its
/// normals, and the motion is found again from these.
/// @param truth  where the simulated part is, of the pictures' size
/// @param first  edges of the real part by other means, which some may be wrong in
/// @param reach_px  how far these may lie from the simulated outline
/// @return nothing where too little of the outline shows on either side
std::optional<GuidedOutlines> guided_outlines(const ImageF& simulated,
                                              const ImageF& real,
                                              const Mask& truth,
                                              std::span<const Boundary> first,
                                              double reach_px);

}  // namespace glint::compare_detail

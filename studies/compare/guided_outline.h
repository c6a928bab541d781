// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part's outline in a real picture, looked for where the simulated one lies: what is bright
// there decides nothing, so edges of light within the part are no outline. Private to the room.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "metrics/overlap/boundary.h"
#include "metrics/overlap/outline_motion.h"

namespace glint::compare_detail {

/// The part's outline in one of the pictures.
struct GuidedOutline {
  std::vector<Boundary> rough;    ///< as the renderer knows it, of the real side moved as a whole
  std::vector<Boundary> located;  ///< at its edges; broken where one of the pictures shows none
  std::vector<Boundary> refined;  ///< closed: the edges, and `rough` where there are none
};

struct GuidedOutlines {
  GuidedOutline simulated;
  GuidedOutline real;
  double share = 0.0;    ///< of the simulated edges that the real picture has
  OutlineMotion motion;  ///< of the simulated outline onto these edges
};

/// The simulated outline is moved by shift, turn, scale and shear until most of the silhouette's
/// edges lie on it (nearest points, robustly), then edges of the same sign are located along its
/// normals, and the motion is found again from what lies between them and the simulated ones. Equal
/// pictures have equal outlines to the last bit.
/// @param truth  where the simulated part is, of the pictures' size
/// @param first  edges of the real part by other means, which some may be wrong in
/// @param reach_px  how far these may lie from the simulated outline
/// @param shift_px  by which the real part may lie farther off, or not; where it is more than some
///                  pixels the search begins there, too
/// @return nothing where too little of the outline shows on either side
std::optional<GuidedOutlines> guided_outlines(const ImageF& simulated,
                                              const ImageF& real,
                                              const Mask& truth,
                                              std::span<const Boundary> first,
                                              double reach_px,
                                              const Eigen::Vector2d& shift_px);

/// That edges do not tell how far the part lies along the direction in which all of them run;
/// nothing where they do.
std::string untold_shift_note(const OutlineMotion& motion);

/// An edge that both pictures have.
struct PairedEdge {
  std::size_t line = 0;  ///< indices of the point of the line that it was looked for at
  std::size_t point = 0;
  BoundaryPoint own;       ///< in the simulated picture
  double offset_px = 0.0;  ///< of the real one along the normal
};

/// Edges along lines of the simulated part that need not be its outline: those of the simulated
/// picture within 1.5 px of a line, and those of the same sign of the real one within 4 px of where
/// the motion takes it. @returns in the order of the lines and their points
std::vector<PairedEdge> edges_along(const ImageF& simulated,
                                    const ImageF& real,
                                    std::span<const Boundary> lines,
                                    const OutlineMotion& motion);

}  // namespace glint::compare_detail

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Edges of the part by the surfaces that they bound, where the simulated picture's geometry is
// known: the face that was machined too low, not only the outline that does not fit.
#pragma once

#include <vector>

#include "studies/compare/compared_pair.h"

namespace glint {

/// Pieces of the outlines along one surface each; edges of light, where these run across a surface;
/// and the creases and steps within the part where both pictures show an edge; the latter are
/// looked for within 4 px of where the outline's motion as a whole takes them. Points of the
/// outline beside a surface without a name belong to no edge.
/// @param pair  whose simulated side may be a rendered view; else the edges stay as they are
/// @throws ConfigError, IoError for files of the view that cannot be read or do not belong together
ListedEdges surface_edges(const ComparedPair& pair);

}  // namespace glint

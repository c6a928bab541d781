// SPDX-License-Identifier: GPL-3.0-or-later
//
// Outlines of regions as closed boundaries: of a mask at another size, moved to located edges, and
// filled again.
#pragma once

#include <span>
#include <vector>

#include "core/image/image.h"
#include "metrics/overlap/boundary.h"
#include "metrics/overlap/edge_location.h"

namespace glint {

/// The closed outlines of a mask, holes included, of a picture `factor` times as large, with about
/// a point a pixel of that picture. Where the region leaves the picture they follow its border.
/// @param factor  >= 1
std::vector<Boundary> outlines_of(const Mask& mask, int factor);

/// Outlines with the points that were located where they were found; the others stay.
std::vector<Boundary> refined(std::vector<Boundary> outlines, std::span<const LocatedEdge> edges);

/// The share of each pixel that lies within closed outlines (within an odd number of them): exact
/// along rows, by four lines a pixel across them.
ImageF filled(std::span<const Boundary> outlines, int width_px, int height_px);

}  // namespace glint

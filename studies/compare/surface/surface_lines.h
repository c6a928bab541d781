// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of a picture along which two surfaces of the part meet.
#pragma once

#include <vector>

#include "metrics/overlap/boundary.h"
#include "studies/compare/surface/named_surfaces.h"

namespace glint {

/// Where two surfaces meet in the picture: lines with about a point a pixel, their normals from the
/// surface of the lower number to the other one.
struct SurfaceLine {
  int from = 0;
  int to = 0;
  Boundary line;  ///< at least 8 points, open
};

std::vector<SurfaceLine> lines_between(const NamedSurfaces& surfaces);

}  // namespace glint

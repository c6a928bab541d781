// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where camera rays end on the tunnel's wall: many places in every pixel, jittered, each ray on its
// own. A pixel is cut into kFilm x kFilm cells of a film, each of which holds samples x samples
// rays.
#pragma once

#include <vector>

#include "core/image/image.h"
#include "studies/stability/reference/reference_scene.h"

namespace glint::stability {

/// Cells of the film along each side of a pixel: fine enough to be blurred on.
inline constexpr int kFilm = 4;

struct ReferenceRays {
  int samples = 1;            ///< along each side of a film cell
  std::vector<double> x_mm;   ///< along the wall, film cell after film cell; NaN: meets no wall
  ImageF coverage;            ///< share of each pixel on the part, height x width
  std::vector<ImageF> radii;  ///< of each dent: mean distance of the pixel's hits, far: 1e9
};

struct RaySampling {
  int samples = 4;        ///< >= 1; along each side of a film cell
  unsigned seed = 1;      ///< of the jitter
  bool has_dents = true;  ///< false: the flawless part
};

/// Where a ray from a point of the part meets the wall's upper half outside the slot; the ends are
/// left to the scan. NaN: nowhere.
double wall_x_mm(const ReferenceWall& wall,
                 const Eigen::Vector3d& origin_mm,
                 const Eigen::Vector3d& direction);

/// Follows all rays. Cost: width x height x (4 samples)^2 rays.
ReferenceRays trace_reference(const ReferenceScene& scene, const RaySampling& sampling);

}  // namespace glint::stability

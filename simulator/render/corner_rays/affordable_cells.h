// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "simulator/render/corner_rays/corner_rays.h"
#include "simulator/render/corner_rays/detail_reach.h"

namespace glint {

/// Rays of refined pixels that a picture may have: 28 bytes each, 0.9 GB.
inline constexpr std::int64_t kMaxRefinedRays = 32'000'000;

/// The largest number of cells per axis with which a picture of the part keeps within the limit, by
/// an estimate: 16, as many as there may be, for nearly all. Bumpy meshes with facets of some
/// pixels are bent in every pixel, and 17 x 17 rays in each of a million are 8 GB, for kinks that
/// no number of cells makes smooth. Does not depend on defects, so that pictures with and without
/// them are cut alike. The same for any number of threads.
/// @param need      of the whole picture; only where vertices appear counts
/// @param max_rays  the limit
/// @return 16, 4 or 2
int affordable_cells(const Part& part,
                     const Bvh& bvh,
                     const PlacedCamera& placed,
                     const RefinementNeed& need,
                     const RenderSettings& settings,
                     ThreadPool& pool,
                     std::int64_t max_rays = kMaxRefinedRays);

/// The number that a picture was traced with. With 16 no pixel is left bent at 2 or 4 cells: bent
/// ones go on to 16, broken ones to 8.
int max_cells_of(const CornerRays& rays);

}  // namespace glint

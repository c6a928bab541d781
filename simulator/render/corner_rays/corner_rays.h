// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ray cache for footprint integration: one ray through each corner of the pixel grid. Four
// corners tell where a pixel's footprint lies on any light, so that edges of the light can be
// integrated over it in closed form (docs/theory/footprints.md) and one ray a pixel is enough.
//
// Where four corners do not describe what happens between them (silhouettes, rays that meet the
// part again, strongly bent places such as defects), the pixel is refined: cut into n x n cells
// with (n + 1)^2 corner rays of its own, n = 2, 4, 8 or 16, until rays taken as bilinear between
// the corners of a cell are wrong by no more than a stated angle, or n is largest.
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/render/corner_rays/sparse_rays.h"
#include "simulator/render/ray_cache/ray_cache.h"

namespace glint {

/// What a pixel's corner rays tell.
enum class PixelKind : std::uint8_t {
  kDark,    ///< no ray meets the part
  kSmooth,  ///< described by its four corners: all met the part, once, with no edge between
  kRefined  ///< its cells are in one of the groups
};

/// Pixels cut into the same number of cells.
struct RefinedGroup {
  int cells_per_axis = 0;            ///< n: n x n cells a pixel
  std::vector<std::int32_t> pixels;  ///< index y * width + x, increasing
  /// One row of (n + 1)^2 rays for each pixel: width_px = (n + 1)^2, height_px = pixels.size().
  RayCache rays;
  /// 1 for a cell (row y * n + x, pixel by pixel) that its four corners describe, as kSmooth.
  std::vector<std::uint8_t> is_smooth;
  std::vector<std::int64_t> special;  ///< as CornerRays::special, among `rays`
};

/// Rays through the corners of all pixels; 28 bytes a ray, and those of sparse_rays.h.
struct CornerRays : VisibilityBuffer {
  RayCache corners;  ///< (width_px + 1) x (height_px + 1) rays: (0, 0) is the image's outer corner
  Image<PixelKind> kind;
  std::vector<RefinedGroup> refined;  ///< by growing cells_per_axis; none is empty
  RayCounts counts;                   ///< of all rays
  /// Corners whose rays met the part more than once, or graze it; increasing.
  std::vector<std::int64_t> special;
  /// Weight of the corners of all smooth pixels; < 0: they differ, or it is not known.
  float smooth_weight = -1.0F;
  SparseRays sparse;  ///< of the corners
};

/// Derivative of escaped rays by one number: six floats a ray, arrays as in RayCache.
struct RayDerivative {
  std::vector<float> origin_x, origin_y, origin_z;           ///< [mm per unit]
  std::vector<float> direction_x, direction_y, direction_z;  ///< [1 per unit]
};

/// Traces the corner rays. The same bytes for any number of threads.
/// @throws ConfigError as trace_rays()
CornerRays trace_corner_rays(const Part& part,
                             const Bvh& bvh,
                             const SurfaceDetail& detail,
                             const PinholeCamera& camera,
                             const RigidTransform& camera_from_world,
                             const RenderSettings& settings,
                             ThreadPool& pool);

/// What retrace_detail() gives.
struct RetracedRays {
  CornerRays rays;
  std::int64_t traced = 0;  ///< rays that were really traced, those of abandoned cells included
};

/// The same bytes as trace_corner_rays() with height features, from the rays of the same part and
/// camera without any. Traces only pixels that a feature's reach is projected onto and those whose
/// rays meet the part more than once.
RetracedRays retrace_detail(const CornerRays& without_detail,
                            const Part& part,
                            const Bvh& bvh,
                            const SurfaceDetail& detail,
                            const PlacedCamera& placed,
                            const RenderSettings& settings,
                            ThreadPool& pool);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Arithmetic on sixteen rays at a time, in double and free of Eigen so that it can be compiled for
// wide instruction sets (docs/decisions/0002-bit-identical-results.md). A ray gets the same bits
// whatever rays stand beside it. All arrays have sixteen numbers and are aligned to 64 bytes.
#pragma once

#include <cstdint>

#include "simulator/geometry/bvh/ray_packet.h"
#include "simulator/render/ray_cache/intersection_kernels.h"

namespace glint {

/// An undistorted camera.
struct PinholeNumbers {
  double focal_x_px = 1, focal_y_px = 1;
  double center_x_px = 0, center_y_px = 0;
  double rotation[9] = {};  ///< world_from_camera, row by row
};

/// Unit directions in the world through points of the image.
void camera_directions16(const PinholeNumbers& camera,
                         const double* x_px,
                         const double* y_px,
                         double* direction_x,
                         double* direction_y,
                         double* direction_z);

/// Points of sixteen pixels of a row of the image: (x + lane) + offset, y + offset.
void row_points16(int x, int y, const double* offset_px, double* x_px, double* y_px);

/// Rays from one point, to be traced; lanes from `count` on are left out.
void ask_from_point16(const double* origin_mm,
                      const double* direction_x,
                      const double* direction_y,
                      const double* direction_z,
                      int count,
                      RayQuery& query);

/// The reflected rays of lanes with a hit (triangle >= 0) that do not graze, to be traced.
void ask_reflected16(const IntersectionLanes& lanes, const std::int32_t* triangle, RayQuery& query);

/// What traced rays met. @return whether any met something
bool take_hits16(const RayQuery& query, HitPacket& hits);

/// The triangle that all lanes met; -1 when there are several, or a miss.
std::int32_t common_triangle16(const HitPacket& hits);

/// True when one of sixteen points is in the box {min x, min y, min z, max x, max y, max z}.
bool is_any_inside16(const double* x_mm,
                     const double* y_mm,
                     const double* z_mm,
                     const double* box_mm);

/// out[i] = in[i] in float, for count numbers of three arrays.
void to_float(const double* const* in, int count, float* const* out);

}  // namespace glint

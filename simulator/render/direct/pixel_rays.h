// SPDX-License-Identifier: GPL-3.0-or-later
//
// Camera rays on a regular grid over some pixels, and the points of the part that they meet.
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/render/path_tracing/packet_stages.h"

namespace glint {

/// Pixels [x, x + width) x [y, y + height), each with per_axis x per_axis rays.
struct RayArea {
  int x_px = 0;
  int y_px = 0;
  int width_px = 0;
  int height_px = 0;
  int per_axis = 1;

  int width() const { return width_px * per_axis; }  ///< of the grid of rays

  int height() const { return height_px * per_axis; }

  int size() const { return width() * height(); }
};

/// What a ray ends at.
enum class RayEnd : std::uint8_t { kNothing, kPart, kLight };

/// Rays row by row, sixteen to a packet.
struct PixelRays {
  RayArea area;
  std::vector<SurfaceLanes> surfaces;  ///< of rays that end at the part
  std::vector<LightHitLanes> lights;   ///< of those that end at a light
  std::vector<RayEnd> ends;            ///< of each ray

  std::size_t ray(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(area.width()) +
           static_cast<std::size_t>(x);
  }

  const SurfaceLanes& surface_of(std::size_t ray) const { return surfaces[ray / kPacketSize]; }

  const LightHitLanes& light_of(std::size_t ray) const { return lights[ray / kPacketSize]; }
};

void trace_pixels(const PathTask& task, const RayArea& area, PixelRays& grid);

}  // namespace glint

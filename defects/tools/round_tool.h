// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// A round procedural tool in its own frame: z = 0 is the surface, it works downwards.
struct RoundTool {
  double diameter_mm = 1.0;  ///< of the opening in a flat surface, before the noise
  double depth_mm = 0.1;     ///< of the lowest point, exactly, after the noise

  /// 2: a ball through rim and lowest point; deeper than its radius, half an ellipsoid. Above 2: a
  /// superellipsoid with a flatter bottom and steeper walls.
  double exponent = 2.0;
  double roughness = 0.0;         ///< rms move of the points as a share of their distance, <= 0.75
  double noise_per_radius = 1.5;  ///< features of the noise on the opening's radius
  double noise_gain = 0.5;        ///< of each octave over the one before; more is rougher
  int level = 3;                  ///< about 20 * 4^level triangles
  double reach_mm = std::numeric_limits<double>::infinity();  ///< at most this far above z = 0
  std::uint64_t seed = 0;
};

/// Caps less deep than half their radius: their lower side is a graph over the surface, so that
/// moving points along z as any function of x and y cannot fold it.
bool is_shallow_cap(const RoundTool& shape);

/// Closed, outwards, and free of crossings whatever the noise: its points move along rays from the
/// middle of the opening, and every ray meets the tool once.
TriangleMesh round_tool(const RoundTool& shape);

/// The mesh mirrored at z = 0, still turned outwards.
TriangleMesh upside_down(TriangleMesh mesh);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "defects/tools/line_frames.h"
#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/part/exact_surface.h"

namespace glint {

/// A procedural scratch or gouge. With depth share s(x) = 1 - |2 x / length|^taper along and
/// t = |2 y / width| across, its lower side lies at depth_mm (t^section - s): both depth and width
/// go to 0 at the ends.
struct LineTool {
  double length_mm = 3.0;  ///< from end to end of the opening in a flat surface
  double width_mm = 0.3;   ///< of the opening, in the middle
  double depth_mm = 0.05;  ///< of the lowest point, exactly, after the noise
  double section = 1.0;    ///< 1: a V; 2: a parabola
  double taper = 6.0;      ///< 2: deepest in the middle only; larger: even, with short ends
  double roughness = 0.0;  ///< rms of the noise, share of the depth and of the half width
  double lean = 0.0;       ///< shift across per height: tangent of the tilt
  int level = 3;           ///< about 20 * 4^level triangles, more where the path bends a lot
  std::uint64_t seed = 0;
};

/// Closed, outwards, in the frame of the path. Sections stay in planes that follow one another
/// without crossing inside the tool: where the path bends too much for that, the frame is averaged
/// over a longer stretch and the part of the tool above the surface made lower.
/// @param patch  the exact surface that the path runs on: sections are bent with it; nullptr: none
TriangleMesh line_tool(const LineTool& shape,
                       const LineFrames& frames,
                       const ExactPatch* patch = nullptr);

}  // namespace glint

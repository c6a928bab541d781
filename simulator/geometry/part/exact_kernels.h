// SPDX-License-Identifier: GPL-3.0-or-later
//
// polish() of exact_surface.h for sixteen rays at a time, free of Eigen so that it can be
// compiled for wide instruction sets (docs/decisions/0002-bit-identical-results.md). Without
// contraction every instruction set gives the same bits, and a ray gets the same bits whatever
// rays stand beside it.
#pragma once

namespace glint {

inline constexpr int kExactLanes = 16;

/// Of Newton's method, here and for single rays.
inline constexpr int kMaxPolishSteps = 20;
inline constexpr double kPolished_mm = 1e-12;

/// An exact surface and its place as plain numbers.
struct PatchCoefficients {
  enum class Kind { kPlane, kParaboloid, kSphere, kCylinder, kInvolute };

  Kind kind = Kind::kPlane;
  double rotation[9] = {};      ///< scene_from_patch, row by row
  double translation[3] = {};   ///< [mm]
  double curvature_along = 0;   ///< paraboloid [1/mm]
  double curvature_across = 0;  ///< paraboloid [1/mm]
  double radius_mm = 0;         ///< sphere, cylinder; base circle of an involute
  double outwards = 1;          ///< cylinder: -1 for a bore
  double hand = 1;              ///< involute; the rotation holds its start
};

/// Sixteen rays that meet a surface: arrays of sixteen numbers that do not overlap.
struct PolishLanes {
  const double *origin_x = nullptr, *origin_y = nullptr, *origin_z = nullptr;           ///< [mm]
  const double *direction_x = nullptr, *direction_y = nullptr, *direction_z = nullptr;  ///< unit
  const double* start_t_mm = nullptr;
  double *point_x = nullptr, *point_y = nullptr, *point_z = nullptr;     ///< out
  double *normal_x = nullptr, *normal_y = nullptr, *normal_z = nullptr;  ///< out, unit
  double* is_found = nullptr;  ///< out: 1 or 0, as polish() gives a hit or none
};

/// polish() for all lanes of one patch: involutes by Newton's method, the others, which are of
/// second degree, by a root. So roots beside a silhouette are found, too, that Newton's method
/// leaves. Lanes may hold anything that is finite; what comes out of those without a ray means
/// nothing.
void polish16(const PatchCoefficients& patch, double max_move_mm, const PolishLanes& lanes);

}  // namespace glint

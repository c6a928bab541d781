// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sixteen rays where they meet the part, and how they leave it: kernels as those of
// packet_kernels.h.
#pragma once

#include <cstdint>

#include "simulator/geometry/bvh/ray_packet.h"

namespace glint {

inline constexpr int kLanes = kPacketSize;

/// Sixteen rays where they meet the part.
struct alignas(64) IntersectionLanes {
  double origin_x[kLanes], origin_y[kLanes], origin_z[kLanes];           ///< of the arriving ray
  double direction_x[kLanes], direction_y[kLanes], direction_z[kLanes];  ///< arriving, unit
  /// Of the triangle, unit, and its plane's offset; afterwards turned against the arriving ray.
  double face_x[kLanes], face_y[kLanes], face_z[kLanes], offset_mm[kLanes];
  double t_mm[kLanes];                                             ///< to the triangle's plane
  double slope[kLanes];                                            ///< of the ray against it
  double point_x[kLanes], point_y[kLanes], point_z[kLanes];        ///< on the surface
  double normal_x[kLanes], normal_y[kLanes], normal_z[kLanes];     ///< of the surface, unit
  double leaving_x[kLanes], leaving_y[kLanes], leaving_z[kLanes];  ///< reflected, unit
  double start_x[kLanes], start_y[kLanes], start_z[kLanes];        ///< of the reflected ray
  double rise[kLanes];         ///< of the reflected ray above the triangle, <= 0: grazing
  double reflectance[kLanes];  ///< of the place, against the clean part
  std::int32_t patch[kLanes];  ///< exact surface that is met, -1: none
};

/// Where rays cut the planes of their triangles: t_mm and slope.
/// @return whether one of them runs almost along its plane: slope of at most `flat`
bool intersect_planes16(double flat, IntersectionLanes& lanes);

/// One plane for all lanes.
void set_plane16(
    double normal_x, double normal_y, double normal_z, double offset_mm, IntersectionLanes& lanes);

/// Rays that arrive from one point.
void arrive16(const double* origin_mm,
              const double* direction_x,
              const double* direction_y,
              const double* direction_z,
              IntersectionLanes& lanes);

/// Weights of rays that leave the part where they met it.
/// @return whether all of the first `count` lanes met it (triangle >= 0) and none grazes
bool weigh_escapes16(const IntersectionLanes& lanes,
                     const std::int32_t* triangle,
                     int count,
                     double reflectance,
                     float* weight);

/// How rays leave the part, one array per component, and where they met it first.
struct EscapeArrays {
  double *seen_x = nullptr, *seen_y = nullptr, *seen_z = nullptr;
  double *origin_x = nullptr, *origin_y = nullptr, *origin_z = nullptr;
  double *direction_x = nullptr, *direction_y = nullptr, *direction_z = nullptr;
};

/// Rays leave the part where they met it first.
void escape16(const IntersectionLanes& lanes, const EscapeArrays& escapes);

/// The same for lanes that met it again (triangle >= 0): their path's reflectance is multiplied by
/// that of this reflection and becomes the weight.
void escape_again16(const IntersectionLanes& lanes,
                    const std::int32_t* triangle,
                    double reflectance,
                    double* path_reflectance,
                    const EscapeArrays& escapes,
                    float* weight);

/// True when a lane with a hit has not been found (is_found 0).
bool is_any_unfound16(const std::int32_t* triangle, const double* is_found);

/// Where rays meet triangles without an exact surface: the normals of their corners.
struct alignas(64) ShadeLanes {
  double is_wanted[kLanes];  ///< 1 for lanes to be set, else 0
  double u[kLanes], v[kLanes];
  double normal_x[3][kLanes], normal_y[3][kLanes], normal_z[3][kLanes];
};

/// Points on the planes at t_mm and normals interpolated between the corners (the face's where they
/// cancel out), for wanted lanes.
void shade16(const ShadeLanes& shade, IntersectionLanes& lanes);

/// Turns face normals against the rays and the surface's with them; a surface normal that still
/// looks away from the ray (at a silhouette) becomes the face's.
void orient16(IntersectionLanes& lanes);

/// Mirrors the rays at the normals: leaving, rise, and the start of the next ray on the triangle
/// at t_mm, lifted by lift_mm along the face normal.
void reflect16(double lift_mm, IntersectionLanes& lanes);

/// Sends the reflected rays on: they become the arriving ones, on a part without stains so far.
void follow16(const IntersectionLanes& from, IntersectionLanes& to);

/// True when all lanes with a hit (triangle >= 0) met the front of their triangle and leave along
/// every normal whose components are between low and high.
bool leave_along16(const IntersectionLanes& lanes,
                   const std::int32_t* triangle,
                   const double* low,
                   const double* high);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Arithmetic on sixteen rays at a time, in double and free of Eigen so that it can be compiled for
// wide instruction sets (docs/decisions/0002-bit-identical-results.md). A ray gets the same bits
// whatever rays stand beside it. All arrays have sixteen numbers and are aligned to 64 bytes.
#pragma once

#include <cstdint>

#include "simulator/geometry/bvh/ray_packet.h"

namespace glint {

inline constexpr int kLanes = kPacketSize;

/// An undistorted camera.
struct PinholeNumbers {
  double focal_x_px = 1, focal_y_px = 1;
  double center_x_px = 0, center_y_px = 0;
  double rotation[9] = {};  ///< world_from_camera, row by row
};

/// Sixteen rays where they meet the part.
struct alignas(64) MeetingLanes {
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

/// Unit directions in the world through points of the image.
void camera_directions16(const PinholeNumbers& camera,
                         const double* x_px,
                         const double* y_px,
                         double* direction_x,
                         double* direction_y,
                         double* direction_z);

/// Where rays cut the planes of their triangles: t_mm and slope.
/// @return whether one of them runs almost along its plane: slope of at most `flat`
bool meet_planes16(double flat, MeetingLanes& lanes);

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
void ask_reflected16(const MeetingLanes& lanes, const std::int32_t* triangle, RayQuery& query);

/// What traced rays met. @return whether any met something
bool take_hits16(const RayQuery& query, HitPacket& hits);

/// The triangle that all lanes met; -1 when there are several, or a miss.
std::int32_t common_triangle16(const HitPacket& hits);

/// One plane for all lanes.
void set_plane16(
    double normal_x, double normal_y, double normal_z, double offset_mm, MeetingLanes& lanes);

/// Rays that arrive from one point.
void arrive16(const double* origin_mm,
              const double* direction_x,
              const double* direction_y,
              const double* direction_z,
              MeetingLanes& lanes);

/// Weights of rays that leave the part where they met it.
/// @return whether all of the first `count` lanes met it (triangle >= 0) and none grazes
bool weigh_escapes16(const MeetingLanes& lanes,
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
void escape16(const MeetingLanes& lanes, const EscapeArrays& escapes);

/// The same for lanes that met it again (triangle >= 0): their path's reflectance is multiplied by
/// that of this reflection and becomes the weight.
void escape_again16(const MeetingLanes& lanes,
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
void shade16(const ShadeLanes& shade, MeetingLanes& lanes);

/// Turns face normals against the rays and the surface's with them; a surface normal that still
/// looks away from the ray (at a silhouette) becomes the face's.
void orient16(MeetingLanes& lanes);

/// Mirrors the rays at the normals: leaving, rise, and the start of the next ray on the triangle
/// at t_mm, lifted by lift_mm along the face normal.
void reflect16(double lift_mm, MeetingLanes& lanes);

/// Sends the reflected rays on: they become the arriving ones, on a part without stains so far.
void follow16(const MeetingLanes& from, MeetingLanes& to);

/// Adds points that were seen (is_seen 1, else 0) to sums, for count numbers. The others must be
/// finite.
struct SeenSums {
  double* hits = nullptr;
  double* x_mm = nullptr;
  double* y_mm = nullptr;
  double* z_mm = nullptr;
};

void add_seen(const double* x_mm,
              const double* y_mm,
              const double* z_mm,
              const double* is_seen,
              int count,
              const SeenSums& sums);

/// Share of `samples` that hit and the mean of their points; zeros without a hit.
void mean_seen(const SeenSums& sums,
               int samples,
               int count,
               float* coverage,
               float* x_mm,
               float* y_mm,
               float* z_mm);

/// mean_seen() of one sample without sums.
void one_seen(const double* from_x_mm,
              const double* from_y_mm,
              const double* from_z_mm,
              const double* is_seen,
              int count,
              float* coverage,
              float* x_mm,
              float* y_mm,
              float* z_mm);

/// True when all lanes with a hit (triangle >= 0) met the front of their triangle and leave along
/// every normal whose components are between low and high.
bool leave_along16(const MeetingLanes& lanes,
                   const std::int32_t* triangle,
                   const double* low,
                   const double* high);

/// True when one of sixteen points is in the box {min x, min y, min z, max x, max y, max z}.
bool is_any_inside16(const double* x_mm,
                     const double* y_mm,
                     const double* z_mm,
                     const double* box_mm);

/// out[i] = in[i] in float, for count numbers of three arrays.
void to_float(const double* const* in, int count, float* const* out);

}  // namespace glint

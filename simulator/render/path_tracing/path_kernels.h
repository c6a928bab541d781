// SPDX-License-Identifier: GPL-3.0-or-later
//
// What sixteen paths do between rays, in float: leave the camera, meet triangles, collect light.
#pragma once

#include "simulator/render/path_tracing/path_packet.h"

namespace glint {

/// A camera without distortion, in the scene frame.
struct CameraNumbers {
  float per_focal_x = 1.0F;
  float per_focal_y = 1.0F;
  float aperture_mm = 0.0F;
  float per_focus = 0.0F;  ///< 1 / mm
  float origin[3] = {};
  float rotation[9] = {};  ///< scene_from_camera, row by row
};

/// Of sixteen camera rays; pairs of random numbers in [0, 1).
struct alignas(64) CameraLanes {
  float column[kPacketSize];  ///< of the pixel's corner over the focal length
  float row[kPacketSize];
  float x_px[kPacketSize], y_px[kPacketSize];  ///< within the pixel
  float lens_u[kPacketSize], lens_v[kPacketSize];
};

void camera_rays16(const CameraNumbers& camera, const CameraLanes& lanes, RayPacket& rays);

/// SobolSampler::pair() as floats below 1.
void random_pairs16(const std::uint32_t* seed,
                    const std::uint32_t* index,
                    std::uint32_t dimension,
                    float* u,
                    float* v);

/// The lay of a material in the scene frame; see simulator/material/lay.h.
struct LayNumbers {
  enum class Kind { kStraight, kTurned, kMilled };

  Kind kind = Kind::kStraight;
  float u[3] = {1.0F, 0.0F, 0.0F};
  float v[3] = {0.0F, 1.0F, 0.0F};
  float centre_u_mm = 0.0F;  ///< along u and v
  float centre_v_mm = 0.0F;
  float lane_mm = 1.0F;
  float radius_mm = 1.0F;
  float part[9] = {1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F};  ///< scene_from_part
};

/// Triangles that rays hit.
struct alignas(64) TriangleLanes {
  VectorLanes face;  ///< unit; zero for a triangle without area, or a lane without a hit
  float offset_mm[kPacketSize];
  VectorLanes corner[3];  ///< normals; all zero: flat
};

/// As intersect_surface() for triangles without exact surface or detail; reflectance and defect are
/// left alone.
void intersect_triangles16(const TriangleLanes& triangles,
                           const LayNumbers& lay,
                           float start_offset_mm,
                           const RayPacket& rays,
                           const HitPacket& hits,
                           SurfaceLanes& surface);

void to_local16(const SurfaceLanes& surface, const VectorLanes& directions, VectorLanes& local);

/// Weights the light that rays met by chance. @param by_choice  false: of the camera
void arrive16(const PathPacket& paths,
              bool by_choice,
              const LightHitLanes& lights,
              ArrivingLanes& arriving);

/// Weights the light of drawn directions.
void connect16(const PathPacket& paths,
               const SurfaceLanes& surface,
               const LightLanes& lights,
               const ReflectionLanes& reflection,
               ArrivingLanes& arriving);

/// Turns paths to the directions their material chose; those that end become invalid.
/// @param roulette  random numbers; null: none ends at random
/// @param is_open   1: nothing can be in the way
void leave16(const SurfaceLanes& surface,
             const LeavingLanes& leaving,
             const float* roulette,
             PathPacket& paths,
             std::int32_t* is_open);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where rays meet the part and how they leave it: sixteen at a time for camera rays, one at a time
// (the reference) for rays that meet the part again.
#pragma once

#include <array>
#include <vector>

#include "simulator/render/packet_kernels.h"
#include "simulator/render/ray_cache.h"

namespace glint {

/// A number for each of sixteen rays.
using Lanes = std::array<double, kPacketSize>;

/// Camera rays of one pinhole; lanes from `count` on are not used.
struct CameraPacket {
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
  alignas(64) Lanes direction_x = {};
  alignas(64) Lanes direction_y = {};
  alignas(64) Lanes direction_z = {};  ///< unit
  int count = 0;
};

/// What rays are traced through; everything it names must outlive it.
class TraceScene {
 public:
  TraceScene(const Part& part,
             const Bvh& bvh,
             const SurfaceDetail& detail,
             const RenderSettings& settings);

  const Part& part;
  const Bvh& bvh;
  const SurfaceDetail& detail;
  const RenderSettings& settings;
  std::vector<PatchCoefficients> patches;  ///< of part.patches
  /// Where features reach; empty when there are so many that SurfaceDetail's grid is quicker.
  std::vector<std::array<double, 6>> feature_boxes;
};

/// Where a ray meets the part, with everything needed to send it on.
struct Interaction {
  Eigen::Vector3d point_mm;
  Eigen::Vector3d start_mm;  ///< for the next ray through the triangles
  Eigen::Vector3d geometric_normal;
  Eigen::Vector3d direction;  ///< of the reflected ray, unit
};

/// A ray at a hit, in plain double arithmetic.
Interaction interact(const TraceScene& scene, const Ray& ray, const Hit& hit);

/// One lane of a packet of hits.
Hit hit_of(const HitPacket& hits, std::size_t lane);

/// Where camera rays meet the part and how they leave it, for lanes with a hit.
/// @param holds_triangles  hits are of nearby rays: where this ray meets a triangle is computed
///                         from its plane instead of taken from the hit (for derivatives)
void meet_part(const TraceScene& scene,
               const CameraPacket& rays,
               const HitPacket& hits,
               bool holds_triangles,
               MeetingLanes& lanes);

}  // namespace glint

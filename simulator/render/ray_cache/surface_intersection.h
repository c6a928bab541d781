// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where rays meet the part and how they leave it, sixteen at a time: camera rays, and those among
// them that meet the part again.
#pragma once

#include <array>
#include <vector>

#include "simulator/render/ray_cache/packet_kernels.h"
#include "simulator/render/ray_cache/ray_cache.h"

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
  std::vector<PatchCoefficients> patches;   ///< of part.patches
  std::array<double, 6> box = {};           ///< around the part, min and max, a little too large
  const EscapeCone* escape_cone = nullptr;  ///< of the part; not set for a convex one
  /// Where features reach; empty when there are so many that SurfaceDetail's grid is quicker.
  std::vector<std::array<double, 6>> feature_boxes;
};

/// Where camera rays meet the part and how they leave it, for lanes with a hit.
/// @param keeps_triangles  hits are of nearby rays: where this ray meets a triangle is computed
///                         from its plane instead of taken from the hit, and micro relief is left
///                         out (for derivatives)
void intersect_part(const TraceScene& scene,
                    const CameraPacket& rays,
                    const HitPacket& hits,
                    bool keeps_triangles,
                    IntersectionLanes& lanes);

/// The same for rays that have left the part and met it again.
/// @param before  how they left it
/// @param hits    of the reflected rays; lanes that met nothing are not followed
void intersect_again(const TraceScene& scene,
                     const IntersectionLanes& before,
                     const HitPacket& hits,
                     IntersectionLanes& lanes);

}  // namespace glint

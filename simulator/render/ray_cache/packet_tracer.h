// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sixteen camera rays at a time, from the pinhole until they have left the part. Shared by the ray
// caches (ray_cache.h, simulator/render/corner_rays/corner_rays.h); results do not depend on which
// rays share a packet.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "simulator/camera/pinhole_camera.h"
#include "simulator/render/ray_cache/ray_cache.h"
#include "simulator/render/ray_cache/surface_intersection.h"

namespace glint {

/// What became of a camera ray.
enum class RayPath : std::uint8_t {
  kMissed,    ///< met nothing
  kOnce,      ///< escaped after one reflection
  kFollowed,  ///< escaped after more
  kBlocked    ///< given up after max_bounces
};

/// How the rays of a packet ended.
struct EscapePacket {
  alignas(64) Lanes origin_x = {};
  alignas(64) Lanes origin_y = {};
  alignas(64) Lanes origin_z = {};
  alignas(64) Lanes direction_x = {};
  alignas(64) Lanes direction_y = {};
  alignas(64) Lanes direction_z = {};  ///< unit; (0, 0, -1) for rays without light
  alignas(64) Lanes seen_x = {};
  alignas(64) Lanes seen_y = {};
  alignas(64) Lanes seen_z = {};  ///< first point on the part; not set when it is missed
  alignas(64) std::array<float, kPacketSize> weight = {};
  alignas(64) Lanes is_seen = {};  ///< 1 for rays that met the part, else 0
  std::array<RayPath, kPacketSize> path = {};
  std::array<bool, kPacketSize> is_grazing = {};
  /// Exact patch that was met first; -1: triangles; not set when the part is missed.
  alignas(64) std::array<std::int32_t, kPacketSize> piece = {};
  bool is_missed = false;  ///< all used lanes missed the part
  bool is_plain = false;   ///< all used lanes escaped after one reflection and none grazes
};

/// The arrays of a packet that kernels write.
EscapeArrays arrays_of(EscapePacket& escapes);

/// A rectangle of the image [px].
struct ImageArea {
  double min_x = -std::numeric_limits<double>::infinity();
  double max_x = std::numeric_limits<double>::infinity();
  double min_y = -std::numeric_limits<double>::infinity();
  double max_y = std::numeric_limits<double>::infinity();

  /// Whether a point of [begin_x, end_x] x [begin_y, end_y] may lie in it.
  bool touches(double begin_x, double end_x, double begin_y, double end_y) const {
    return end_x >= min_x && begin_x <= max_x && end_y >= min_y && begin_y <= max_y;
  }
};

/// Rays of a camera in the scene frame.
class CameraRays {
 public:
  CameraRays(const PinholeCamera& camera, const RigidTransform& camera_from_world);

  /// Rays through `count` <= 16 points of the image [px], (0, 0) its outer corner.
  void through(const double* x_px, const double* y_px, int count, CameraPacket& rays) const;

  /// Where the rays through a box {min x, min y, min z, max x, ...} pass the image; may be larger.
  ImageArea area_of(const std::array<double, 6>& box_mm) const;

 private:
  const PinholeCamera& camera_;
  RigidTransform world_from_camera_;
  PinholeNumbers numbers_;
  bool is_distorted_ = false;
};

/// Traces packets one after the other; one tracer a thread.
class PacketTracer {
 public:
  explicit PacketTracer(const TraceScene& scene) : scene_(scene) {}

  void trace(const CameraPacket& rays, EscapePacket& escapes);

  /// What the camera rays of the last packet met.
  const HitPacket& hits() const { return hits_; }

 private:
  void follow(EscapePacket& escapes);
  void give_up(EscapePacket& escapes) const;
  bool leaves_for_good() const;

  const TraceScene& scene_;
  RayQuery query_;
  HitPacket hits_;
  HitPacket again_;                  ///< of the reflected rays
  IntersectionLanes lanes_ = {};     ///< of the camera rays
  IntersectionLanes followed_ = {};  ///< of those that meet the part again
};

/// Adds what became of lanes [0, count).
void add_counts(const EscapePacket& escapes, int count, RayCounts& counts);
RayCounts& operator+=(RayCounts& sum, const RayCounts& counts);

/// Rays only, left unset; the images of VisibilityBuffer stay empty.
void resize_rays(RayCache& cache, std::size_t count);

/// Writes lanes [0, count) to rays first, first + 1, ... of the cache.
void store_rays(const EscapePacket& escapes, int count, RayCache& cache, std::size_t first);

/// The same for rays that missed the part.
void store_missed(std::size_t first, std::size_t count, RayCache& cache);

/// @throws ConfigError when this many rays of 28 bytes do not fit into half of the machine's
///         memory; `what` starts the sentence ("render.rays_per_axis: 8 x 8 px with 4 rays each").
void check_ray_memory(double num_rays, const std::string& what);

/// @throws ConfigError when no ray met the part
void check_part_is_seen(const RayCounts& counts);

}  // namespace glint

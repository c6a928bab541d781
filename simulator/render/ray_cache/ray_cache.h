// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ray cache: where the rays of a camera go after the mirror-like part has sent them on. It does
// not depend on the lighting, so it is traced once per part, camera and defects; a candidate
// lighting is then an evaluation along the kept rays (docs/decisions/0003-ray-cache.md).
//
// Level 0 of light transport: perfect mirror of one reflectance, geometric optics. A reflected ray
// that meets the part again is reflected again, up to max_bounces; after that it is dark and
// counted. Camera rays that miss the part are dark.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/image/image.h"
#include "core/image/uninitialized_allocator.h"
#include "core/pose.h"
#include "core/thread_pool.h"
#include "simulator/camera/pinhole_camera.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"
#include "simulator/geometry/surface/surface_detail.h"
#include "simulator/light/tunnel/tunnel_kernels.h"
#include "simulator/render/ray_cache/render_settings.h"

namespace glint {

/// What became of the camera rays.
struct RayCounts {
  std::int64_t camera = 0;    ///< all
  std::int64_t part = 0;      ///< met the part
  std::int64_t followed = 0;  ///< escaped after more than one reflection
  std::int64_t blocked = 0;   ///< given up after max_bounces: dark
  std::int64_t grazing = 0;   ///< left almost along the triangles, taken as escaped
};

/// A camera at its place.
struct PlacedCamera {
  PinholeCamera camera;
  RigidTransform camera_from_world;
};

/// What of the part each pixel sees. 16 bytes a pixel.
struct VisibilityBuffer {
  int width_px = 0;
  int height_px = 0;
  ImageF coverage;                     ///< share of the pixel that lies on the part
  ImageF seen_x, seen_y, seen_z;       ///< [mm] mean point of the part that its rays met first
  std::optional<PlacedCamera> camera;  ///< whose pixels they are; empty: not known

  std::int64_t num_pixels() const {
    return static_cast<std::int64_t>(width_px) * static_cast<std::int64_t>(height_px);
  }

  /// The points seen by pixels [begin, begin + count), as origins; without directions.
  RayBlock seen_points(std::int64_t begin, int count) const;
};

/// How many of the part's pixels a mask marks, as a share of all of them; 0 where it is empty.
/// @param mask  1 on pixels of the part only
double share_of_part(const Mask& mask, const VisibilityBuffer& seen);

/// Rays that have left the part, one array per component: ray of sample s in pixel p stands at
/// s * num_pixels() + p. 28 bytes a ray.
struct RayCache : VisibilityBuffer {
  using Floats =
      std::vector<float, UninitializedAllocator<float>>;  ///< zeroing would cost a twentieth

  int samples = 0;                               ///< rays a pixel
  Floats origin_x, origin_y, origin_z;           ///< [mm], scene frame
  Floats direction_x, direction_y, direction_z;  ///< unit
  Floats weight;  ///< reflectance of the path; 0: dark whatever the light
  RayCounts counts;

  /// Rays [begin, begin + count) of the arrays.
  RayBlock block(std::int64_t begin, int count) const;
};

/// Traces the rays of a camera. The same bytes for any number of threads.
/// @throws ConfigError when no ray meets the part ("camera: the part is outside the image"), or
/// when
///         the rays do not fit into the machine's memory
RayCache trace_rays(const Part& part,
                    const Bvh& bvh,
                    const SurfaceDetail& detail,
                    const PinholeCamera& camera,
                    const RigidTransform& camera_from_world,
                    const RenderSettings& settings,
                    ThreadPool& pool);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scan: the tunnel moves along x step by step and the camera takes a picture at each position.
// The cached rays are evaluated against the wall once per lighting, then against the stripes once
// per frame.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "simulator/light/tunnel/scan_settings.h"
#include "simulator/light/tunnel/tunnel.h"
#include "simulator/render/ray_cache/ray_cache.h"
#include "simulator/sensor/sensor.h"

namespace glint {

/// Cached rays under one tunnel: where each meets the wall and how bright the wall is before
/// stripes. Arrays as in RayCache.
struct WallRays {
  std::vector<float> x_mm;
  std::vector<float> pattern_mm;  ///< empty: equal to x_mm
  std::vector<float> gain;        ///< 0: dark at every position
  /// Gain times the radiance of dark stripes at the hit; empty: that of the pattern.
  std::vector<float> shine;
  double hidden_share = 0.0;  ///< of the part's pixels, hidden from the camera by the wall
};

/// Evaluates the cache against a tunnel. @param cache  of a camera that it knows, standing there
WallRays intersect_wall(const RayCache& cache,
                        const Tunnel& tunnel,
                        const Eigen::Vector3d& camera_in_world_mm);

/// The pictures' radiance with the tunnel at several positions, rays read once for all of them.
/// @param patterns  Tunnel::pattern() at each position
/// @param frames    as many; resized when they have another size
void render_frames(const RayCache& cache,
                   const WallRays& rays,
                   std::span<const StripePattern> patterns,
                   std::span<ImageF> frames);

/// The same for one position.
void render_frame(const RayCache& cache,
                  const WallRays& rays,
                  const StripePattern& pattern,
                  ImageF& radiance);

/// What a scan leaves.
struct ScanResult {
  ScanSums sums;
  ImageF aspect;              ///< mean of the frames
  double hidden_share = 0.0;  ///< of the part's pixels, hidden from the camera by the wall
};

/// Called with each frame's grey values, in order.
using FrameConsumer = std::function<void(int index, const ImageF& grey)>;

/// Takes all frames. `consume` may be empty: then frames are summed without being kept.
ScanResult take_scan(const RayCache& cache,
                     const Tunnel& tunnel,
                     const Sensor& sensor,
                     const ScanSettings& scan,
                     const Eigen::Vector3d& camera_in_world_mm,
                     const FrameConsumer& consume = {});

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scan along kept rays (RayCache): of a mirror by the wall that each meets, of rough metal by the
// lobe around it (simulator/render/blurred). Both have a ray for each place of a pixel, and no
// noise but the sensor's.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/thread_pool.h"
#include "simulator/light/tunnel/tunnel.h"
#include "simulator/render/path_tracing/conductor_kernels.h"
#include "simulator/render/ray_cache/ray_cache.h"
#include "simulator/render/scan/scan.h"
#include "simulator/sensor/sensor.h"
#include "studies/definition/scene.h"

namespace glint {

/// How a scene's kept rays bring light. Safe to use from several threads.
class KeptRayScan {
 public:
  /// @param scene  without needs_paths(); one of blurred reflections has no blurred_problems()
  /// @throws ConfigError, IoError as SurfaceMaterial
  KeptRayScan(const SceneSettings& scene, ThreadPool& pool);

  const Tunnel& tunnel() const { return tunnel_; }

  /// @param sensor   of the rays' picture, or of a window of it
  /// @param consume  sees each frame's grey values in order; may be empty
  /// @throws ConfigError "render.method" where stripes are too fine for the lobe (harmonics_for())
  ScanResult scan(const RayCache& rays,
                  const Sensor& sensor,
                  const Eigen::Vector3d& camera_in_world_mm,
                  const FrameConsumer& consume = {}) const;

 private:
  Tunnel tunnel_;
  ScanSettings settings_;
  std::optional<ConductorNumbers> metal_;  ///< of blurred reflections; empty: a mirror
  ThreadPool& pool_;
};

}  // namespace glint

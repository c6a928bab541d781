// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/pose.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/render/path_tracing/packet_numbers.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/path_tracing/physical_scene.h"
#include "simulator/render/path_tracing/sobol.h"

namespace glint {

/// Pairs of SobolSampler: two for the camera, then three for each reflection.
inline constexpr std::uint32_t kPixelPair = 0;
inline constexpr std::uint32_t kLensPair = 1;
inline constexpr std::uint32_t kFirstReflectionPair = 2;
inline constexpr std::uint32_t kPairsPerReflection = 3;

/// What all tiles of a picture share.
class PathTask {
 public:
  PathTask(const PhysicalScene& scene, const PathSettings& settings);

  const PhysicalScene& scene;
  const PathSettings& settings;
  ThinLensCamera camera;
  RigidTransform scene_from_camera;
  double start_offset_mm = 0.0;
  Coherence bounces = Coherence::kIncoherent;  ///< rays that leave the part stay close or do not
  std::vector<double> factors;                 ///< of the light groups; empty: no light
  std::vector<std::int32_t> ids;               ///< of all defects, rising

  // What the packet kernels know; the rest is done ray by ray.
  std::optional<CameraNumbers> camera_numbers;
  std::optional<ConductorNumbers> metal;
  LayNumbers lay;
  /// Of the part, not asked where it is convex: 1 for triangles that nothing rises above.
  const std::vector<std::uint8_t>& is_open;
  const std::vector<std::uint8_t>& flat_triangles;
  std::vector<std::uint8_t> curved_triangles;  ///< 1: of an exact surface that is no plane
  bool intersects_by_kernel = true;            ///< triangles away from those and from detail
  bool is_mirror = false;
  bool needs_choice = false;  ///< the material uses a third random number
};

/// The ray of one sample through a place of the image [px].
Ray camera_ray(const PathTask& task, const Eigen::Vector2d& pixel_px, const SobolSampler& numbers);

}  // namespace glint

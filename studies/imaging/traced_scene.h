// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scene made ready: part built, rays traced, defects seen by the camera, region of interest.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "metrics/aspect_image/defect_scores.h"
#include "metrics/aspect_image/roi.h"
#include "simulator/render/corner_rays/corner_rays.h"
#include "studies/definition/scene.h"
#include "studies/imaging/built_part.h"

namespace glint {

/// Everything about a scene that does not depend on its lighting and sensor.
struct TracedScene {
  std::shared_ptr<const BuiltDefects> part;
  RigidTransform camera_from_world;
  Eigen::Vector3d camera_in_world_mm = Eigen::Vector3d::Zero();
  RayCache rays;       ///< of a scene that keeps_rays(); else empty
  CornerRays corners;  ///< of all other methods, where paths are traced only its VisibilityBuffer
  std::vector<DefectView> views;
  std::vector<DefectPixels> defects;
  std::vector<std::string> unseen;  ///< labels of defects that were left out of both
  /// For each view its window without defects, sampled; none where paths are traced.
  std::vector<RayCache> flawless;
  std::vector<CornerRays> flawless_corners;  ///< the same for all other methods
  Mask part_mask;                            ///< pixels wholly on the part
  Region region;                             ///< of interest for homogeneity
  Mask watched;                              ///< pixels of the defects and their backgrounds

  /// What rays meet.
  const BuiltPart& built() const { return *part->built; }

  const SurfaceDetail& detail() const { return part->detail; }

  bool is_sampled() const { return corners.width_px == 0; }

  const VisibilityBuffer& seen() const {
    return is_sampled() ? static_cast<const VisibilityBuffer&>(rays) : corners;
  }

  const RayCounts& counts() const { return is_sampled() ? rays.counts : corners.counts; }
};

/// What a camera may fail to see without this being an error.
enum class MayBeUnseen : std::uint8_t {
  kNothing,
  kDefects,  ///< left out of what is scored (TracedScene::unseen)
  kPart,     ///< that too, and the region may be empty: somebody wants the picture, not its scores
};

/// Traces a scene anew, or only around its defects.
/// @param defect_free     the camera's rays without defects; nullptr: not known
/// @throws ConfigError beginning with the key at fault
TracedScene trace_scene(const SceneSettings& scene,
                        std::shared_ptr<const BuiltDefects> part,
                        const CornerRays* defect_free,
                        ThreadPool& pool,
                        MayBeUnseen may_be_unseen = MayBeUnseen::kNothing);

/// Whether its picture is made along TracedScene::rays: plain sampling and blurred reflections.
bool keeps_rays(const SceneSettings& scene);

/// The pixels that lie on the part as a whole where a scan is scored in them: of mirrors under a
/// tunnel. Empty where paths are traced, whose masks are those of the picture's own samples.
std::optional<Mask> scanned_part_mask(const SceneSettings& scene, const TracedScene& traced);

/// How the camera sees each defect: windows of distances in defect radii.
std::vector<DefectView> view_defects(std::span<const HeightFeature> outlines,
                                     const VisibilityBuffer& seen,
                                     const PinholeCamera& camera,
                                     const RigidTransform& camera_from_world,
                                     double window_radii);

/// @param index  of the viewpoint in its list, for the error
/// @throws ConfigError when the camera is inside the part
void check_camera_outside_part(const CameraSettings& camera,
                               const Viewpoint& viewpoint,
                               std::size_t index,
                               const TriangleMesh& part);

/// @throws ConfigError when the part does not fit into the tunnel at every position of the scan.
void check_part_in_tunnel(const BuiltPart& built,
                          const Tunnel& tunnel,
                          const ScanSettings& scan,
                          const std::string& name);

}  // namespace glint

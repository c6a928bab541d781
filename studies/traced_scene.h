// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scene made ready: part built, rays traced, defects seen by the camera, region of interest. What
// the lighting does not change is kept between candidates, found again by the content of the tables
// it depends on.
#pragma once

#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "metrics/defect_scores.h"
#include "metrics/roi.h"
#include "simulator/render/corner_rays.h"
#include "studies/scene.h"

namespace glint {

/// A part with its BVH, and the outline that must fit into a tunnel.
struct BuiltPart {
  Part part;
  std::unique_ptr<Bvh> bvh;
  std::vector<Eigen::Vector2d> outline_yz_mm;  ///< convex hull of the part's projection along x
  double min_x_mm = 0.0;
  double max_x_mm = 0.0;
};

/// Everything about a scene that does not depend on its lighting and sensor.
struct TracedScene {
  std::shared_ptr<const BuiltPart> built;
  SurfaceDetail detail;
  RigidTransform camera_from_world;
  Eigen::Vector3d camera_in_world_mm = Eigen::Vector3d::Zero();
  RayCache rays;       ///< of the plain way (render.method = "sampled"); else empty
  CornerRays corners;  ///< of all other methods; else empty
  std::vector<DefectView> views;
  std::vector<DefectPixels> defects;
  std::vector<RayCache> flawless;            ///< for each view its window without defects, sampled
  std::vector<CornerRays> flawless_corners;  ///< the same for all other methods
  Mask part_mask;                            ///< pixels wholly on the part
  Mask region;                               ///< of interest for homogeneity
  Mask watched;                              ///< pixels of the defects and their backgrounds

  bool is_sampled() const { return corners.width_px == 0; }

  const SeenPart& seen() const {
    return is_sampled() ? static_cast<const SeenPart&>(rays) : corners;
  }

  const RayCounts& counts() const { return is_sampled() ? rays.counts : corners.counts; }
};

/// Builds scenes and keeps the last few. Safe to use from several threads.
class SceneStore {
 public:
  explicit SceneStore(ThreadPool& pool) : pool_(pool) {}

  /// @throws ConfigError beginning with the key at fault, IoError
  std::shared_ptr<const TracedScene> trace(const SceneSettings& scene);
  std::shared_ptr<const BuiltPart> build(const SceneSettings& scene);

  ThreadPool& pool() const { return pool_; }

  int num_traced() const { return num_traced_; }  ///< how often rays were traced

 private:
  template <class Value>
  struct Entry {
    std::string key;
    std::shared_ptr<const Value> value;
  };

  /// @throws IoError when the file cannot be read, or is another one than at first
  void check_file(const std::filesystem::path& file);

  ThreadPool& pool_;
  std::mutex mutex_;
  std::map<std::string, std::string> digests_;  ///< of part files, by path
  std::list<Entry<BuiltPart>> parts_;           ///< most recently used first
  std::list<Entry<TracedScene>> traced_;        ///< most recently used first
  int num_traced_ = 0;
};

/// How the camera sees each defect: windows of distances in defect radii.
std::vector<DefectView> view_defects(const SurfaceDetail& detail,
                                     const SeenPart& seen,
                                     const PinholeCamera& camera,
                                     const RigidTransform& camera_from_world,
                                     double window_radii);

/// @throws ConfigError when the part does not fit into the tunnel at every position of the scan.
void check_part_in_tunnel(const BuiltPart& built,
                          const Tunnel& tunnel,
                          const ScanSettings& scan,
                          const std::string& name);

}  // namespace glint

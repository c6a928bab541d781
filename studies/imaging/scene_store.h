// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scenes made ready and kept: what the lighting does not change is found again by the content of
// the tables it depends on.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "core/cache.h"
#include "core/thread_pool.h"
#include "simulator/render/footprint/footprints.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/scan/frame_pictures.h"
#include "studies/imaging/line_store.h"
#include "studies/imaging/path_picture.h"
#include "studies/imaging/traced_scene.h"

namespace glint {

/// Builds scenes and keeps the last few. Safe to use from several threads.
class SceneStore {
 public:
  /// @param max_bytes  what traced scenes and wall views that are kept may take together (the last
  ///                    scene is kept in any case), or traced scenes and pictures by path tracing;
  ///                    0: a quarter of the machine's memory
  explicit SceneStore(ThreadPool& pool, std::size_t max_bytes = 0);

  /// From now on defects that the camera does not see are left out of what is scored
  /// (TracedScene::unseen) instead of being an error.
  void leave_out_unseen_defects() { may_be_unseen_ = MayBeUnseen::kDefects; }

  /// Nor need it see enough of the part for a score: the pictures alone are wanted.
  void leave_out_scores() { may_be_unseen_ = MayBeUnseen::kPart; }

  /// @throws ConfigError beginning with the key at fault, IoError
  std::shared_ptr<const TracedScene> trace(const SceneSettings& wanted);
  std::shared_ptr<const BuiltPart> build(const SceneSettings& scene);

  /// The scene's part with its defects; made once for the same part, groups and seed.
  std::shared_ptr<const BuiltDefects> build_defects(const SceneSettings& scene);

  /// The picture of the scene's first viewpoint by path tracing, all lights at power 1.
  /// @param preview  of a picture that is not there yet; one that it stops is kept as it is
  /// @throws ConfigError beginning with the key at fault, IoError
  std::shared_ptr<const PathPicture> picture(const SceneSettings& scene,
                                             const PathPreview& preview = {});

  /// The same without the scene's defects, and only in some windows; empty: everywhere. With the
  /// same random numbers, so that the two differ by the defects alone.
  std::shared_ptr<const PathPicture> flawless_picture(const SceneSettings& scene,
                                                      std::span<const PixelWindow> windows);

  /// What simulated lines of path-traced parts have rendered.
  LineStore& lines() { return lines_; }

  /// For scans of any of the scenes.
  FramePicturePool& frame_pictures() { return frame_pictures_; }

  ThreadPool& pool() const { return pool_; }

  /// Where rays meet the tunnel's wall. Views that are asked for again are kept from the second
  /// time on, so that candidates that differ in their stripes alone meet the wall once, and others
  /// do not fill the memory.
  /// @param rays  one of the scene's CornerRays
  std::shared_ptr<const WallView> intersect(const std::shared_ptr<const TracedScene>& traced,
                                            const CornerRays& rays,
                                            const Tunnel& tunnel);

  int num_traced() const { return traced_.num_made(); }  ///< how often rays were traced

  /// How often of these only the rays around the defects were.
  int num_retraced() const { return num_retraced_; }

  /// How often paths were traced: once for designs that differ in the powers of their lights.
  int num_rendered() const { return pictures_.num_made(); }

  int num_intersected() const { return num_intersected_; }  ///< how often a wall was met

  /// How often the defects of a part were made.
  int num_defects_made() const { return defects_.num_made(); }

  std::size_t kept_bytes() const;

 private:
  /// Content of the tables that a value depends on, and what else it was made from.
  template <class Source>
  struct MadeFrom {
    std::string tables;
    std::shared_ptr<const Source> source;

    bool operator==(const MadeFrom&) const = default;
  };

  struct PictureKey {
    std::string view;
    bool has_defects = true;
    std::vector<PixelWindow> windows = {};

    bool operator==(const PictureKey&) const = default;
  };

  /// Corner rays of a traced scene, which they do not keep alive.
  struct RaysKey {
    std::weak_ptr<const TracedScene> traced;
    const CornerRays* rays = nullptr;

    bool operator==(const RaysKey& other) const {
      return rays == other.rays && !traced.owner_before(other.traced) &&
             !other.traced.owner_before(traced);
    }
  };

  struct WallKey {
    RaysKey rays;
    std::string tunnel;

    bool operator==(const WallKey&) const = default;
  };

  struct IntersectedWall {
    std::shared_ptr<const WallView> view;  ///< empty: was asked for once
  };

  /// The camera's rays without defects, if the last scene had the same camera; else empty.
  std::shared_ptr<const CornerRays> defect_free_rays(const SceneSettings& scene,
                                                     const BuiltDefects& part);

  /// @throws IoError when the file cannot be read, or is another one than at first
  void check_file(const std::filesystem::path& file);
  void check_files(const SceneSettings& scene);

  ThreadPool& pool_;
  std::size_t max_bytes_ = 0;
  MayBeUnseen may_be_unseen_ = MayBeUnseen::kNothing;
  std::mutex digests_mutex_;
  std::map<std::string, std::string> digests_;  ///< of part files, by path
  Cache<std::string, BuiltPart> parts_;
  Cache<MadeFrom<BuiltPart>, DefectMaker> makers_;
  Cache<MadeFrom<BuiltPart>, BuiltDefects> defects_;
  Cache<MadeFrom<BuiltDefects>, TracedScene> traced_;
  Cache<PictureKey, PathPicture> pictures_;
  Cache<WallKey, IntersectedWall> walls_;
  mutable std::mutex defect_free_mutex_;
  std::string defect_free_key_;                    ///< of the last camera that was traced
  std::shared_ptr<const CornerRays> defect_free_;  ///< its rays without defects
  bool is_defect_free_too_large_ = false;          ///< to be kept
  LineStore lines_;
  FramePicturePool frame_pictures_;
  std::atomic<int> num_retraced_ = 0;
  std::atomic<int> num_intersected_ = 0;
};

/// Memory that the rays of a scene take, about.
std::size_t bytes_of(const TracedScene& traced);

/// The scene with the viewpoints of its set as a list, whose first one is scored.
/// @throws ConfigError beginning with the key at fault, IoError
SceneSettings first_view(SceneStore& store, SceneSettings scene);

/// Nothing for a scene without a tunnel.
/// @throws ConfigError when the part does not fit into the tunnel at every position of the scan
void check_part_in_tunnel(SceneStore& store, const SceneSettings& scene);

/// @throws ConfigError when the camera of a viewpoint is inside the part
void check_cameras_outside_part(SceneStore& store, const SceneSettings& scene);

}  // namespace glint

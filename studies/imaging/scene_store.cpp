// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/scene_store.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include <fmt/format.h>
#include <unistd.h>

#include "core/config/key_digest.h"
#include "core/file.h"
#include "core/text.h"
#include "studies/definition/render_methods.h"
#include "studies/definition/scene_viewpoints.h"

namespace glint {
namespace {

constexpr std::size_t kKeptParts = 2;
constexpr std::size_t kKeptDefects = 4;
constexpr std::size_t kKeptScenes = 3;
constexpr std::size_t kKeptPictures = 2;  // at least: of one scene, with and without its defects
constexpr std::size_t kKeptWalls = 64;

std::string part_key(PartSettings part) {
  std::string key;
  KeyDigest digest(key);
  visit_keys(digest, part);
  return key;
}

/// Of everything that drawing defects depends on, but for the seed.
std::string maker_key(SceneSettings scene) {
  std::string key = part_key(scene.part);
  KeyDigest digest(key);
  for (auto& [name, group] : scene.defects) {
    digest.text("name", name, "");
    visit_keys(digest, group);
  }
  scene.imprint.seed = 0;
  visit_keys(digest, scene.imprint);
  return key;
}

/// Of everything that a part's defects depend on. Which realisation `auto` takes depends on where
/// the camera stands.
std::string defects_key(SceneSettings scene) {
  std::string key = maker_key(scene);
  KeyDigest digest(key);
  visit_keys(digest, scene.imprint);
  const bool is_open = std::ranges::any_of(scene.defects, [](const NamedGroup& group) {
    return group.second.realisation == Realisation::kAuto;
  });
  if (is_open) {
    visit_keys(digest, scene.viewpoint());
  }
  return key;
}

/// Of everything that tracing depends on.
std::string trace_key(SceneSettings scene) {
  std::string key = defects_key(scene);
  KeyDigest digest(key);
  visit_keys(digest, scene.camera);
  digest.number("focus_mm", scene.lens.focus_mm, {}, "");
  visit_keys(digest, scene.viewpoint());
  visit_keys(digest, scene.render);
  digest.number("reflectance", scene.render.reflectance, {}, "");
  visit_keys(digest, scene.metrics);
  return key;
}

/// Of everything about a tunnel that its stripes leave alone.
std::string wall_key(TunnelSettings tunnel) {
  const TunnelSettings defaults;
  tunnel.period_mm = defaults.period_mm;
  tunnel.duty = defaults.duty;
  tunnel.offset_mm = defaults.offset_mm;
  tunnel.dark_reflectance = defaults.dark_reflectance;
  tunnel.led_ripple = defaults.led_ripple;
  tunnel.led_pitch_mm = defaults.led_pitch_mm;
  tunnel.end_falloff = defaults.end_falloff;
  std::string key;
  KeyDigest digest(key);
  visit_keys(digest, tunnel);
  return key;
}

std::size_t bytes_of(const RayCache& rays) {
  constexpr std::size_t kPerRay = 7 * sizeof(float);
  constexpr std::size_t kPerPixel = 4 * sizeof(float);
  return kPerRay * rays.weight.size() + kPerPixel * rays.coverage.size();
}

std::size_t bytes_of(const CornerRays& rays) {
  constexpr std::size_t kPerPixel = 4 * sizeof(float) + sizeof(PixelKind);
  std::size_t bytes = kPerPixel * rays.coverage.size() + bytes_of(rays.corners);
  for (const RefinedGroup& group : rays.refined) {
    bytes +=
        sizeof(std::int32_t) * group.pixels.size() + bytes_of(group.rays) + group.is_smooth.size();
  }
  return bytes;
}

std::size_t machine_bytes() {
  return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
}

/// What of [render] tracing depends on.
SceneSettings as_traced(SceneSettings scene) {
  using Method = RenderSettings::Method;
  const RenderSettings defaults;
  if (keeps_rays(scene)) {
    scene.render.max_direction_error_rad = defaults.max_direction_error_rad;
  } else {
    // Masks and distances of a path-traced scene come from the same rays, its light does not.
    scene.render.method = needs_paths(scene) ? Method::kPaths : Method::kIntegrated;
    scene.render.rays_per_axis = defaults.rays_per_axis;
  }
  if (scene.render.method == Method::kPaths || is_blurred(scene)) {
    scene.render.reflectance = defaults.reflectance;
  }
  return scene;
}

}  // namespace

SceneStore::SceneStore(ThreadPool& pool, std::size_t max_bytes)
    : pool_(pool),
      max_bytes_(max_bytes > 0 ? max_bytes : machine_bytes() / 4),
      parts_({.max_values = kKeptParts}),
      makers_({.max_values = kKeptParts}),
      defects_({.max_values = kKeptDefects}),
      traced_({.max_values = kKeptScenes, .max_bytes = max_bytes_ / 2},
              [](const auto&, const TracedScene& traced) { return bytes_of(traced); }),
      pictures_({.max_bytes = max_bytes_ / 2, .min_values = kKeptPictures},
                [](const auto&, const PathPicture& picture) {
                  return static_cast<std::size_t>(picture.bytes());
                }),
      walls_({.max_values = kKeptWalls, .max_bytes = max_bytes_ / 2, .min_values = 0},
             [](const auto&, const IntersectedWall& wall) {
               return wall.view ? wall.view->bytes() : 0;
             }) {}

std::size_t SceneStore::kept_bytes() const {
  const std::scoped_lock lock(defect_free_mutex_);
  return (defect_free_ ? bytes_of(*defect_free_) : 0) + traced_.bytes() + pictures_.bytes() +
         walls_.bytes();
}

void SceneStore::check_file(const std::filesystem::path& file) {
  if (file.empty()) {
    return;
  }
  const std::string digest = sha256_hex(read_file(file));
  const std::scoped_lock lock(digests_mutex_);
  const auto [known, is_new] = digests_.emplace(file.string(), digest);
  if (!is_new && known->second != digest) {
    throw IoError(file.string() +
                  ": has changed while the study was running; start again in a new folder");
  }
}

/// The files that pictures are made of.
void SceneStore::check_files(const SceneSettings& scene) {
  for (const std::filesystem::path& file : input_files(scene)) {
    check_file(file);
  }
}

std::shared_ptr<const BuiltPart> SceneStore::build(const SceneSettings& scene) {
  return parts_.get(part_key(scene.part), [&] {
    check_file(scene.part.file);
    return build_part_with_bvh(scene.part);
  });
}

std::shared_ptr<const BuiltDefects> SceneStore::build_defects(const SceneSettings& scene) {
  const std::shared_ptr<const BuiltPart> clean = build(scene);
  return defects_.get({defects_key(scene), clean}, [&] {
    const auto maker =
        makers_.get({maker_key(scene), clean}, [&] { return defect_maker(scene, clean); });
    return glint::build_defects(
        scene, clean, *maker, static_cast<std::uint64_t>(scene.imprint.seed));
  });
}

std::shared_ptr<const TracedScene> SceneStore::trace(const SceneSettings& wanted) {
  const SceneSettings scene = as_traced(wanted);
  const std::shared_ptr<const BuiltDefects> part = build_defects(scene);
  const auto drop_walls = [&] {
    walls_.erase_if([](const WallKey& key) { return key.rays.traced.expired(); });
  };
  auto traced = traced_.get({trace_key(scene), part}, [&] {
    if (2 * traced_.bytes() > max_bytes_ / 2) {  // another as large may not fit beside them
      traced_.erase_if([](const auto&) { return true; });
      drop_walls();
    }
    const std::shared_ptr<const CornerRays> defect_free = defect_free_rays(scene, *part);
    TracedScene made = trace_scene(scene, part, defect_free.get(), pool_, may_be_unseen_);
    num_retraced_ += defect_free ? 1 : 0;
    return made;
  });
  drop_walls();
  return traced;
}

/// From the second set of defects for one camera on, the rays without any are worth having.
std::shared_ptr<const CornerRays> SceneStore::defect_free_rays(const SceneSettings& scene,
                                                               const BuiltDefects& part) {
  if (keeps_rays(scene) || needs_paths(scene) || scene.defects.empty() ||
      part.built != part.clean) {
    return nullptr;
  }
  SceneSettings defect_free = scene;
  defect_free.defects.clear();
  defect_free.imprint = {};
  defect_free.metrics = {};
  const std::string key = trace_key(defect_free);
  const std::scoped_lock lock(defect_free_mutex_);
  if (defect_free_key_ != key) {
    defect_free_key_ = key;
    defect_free_.reset();
    is_defect_free_too_large_ = false;
    traced_.set_max_bytes(max_bytes_ / 2);
    return nullptr;
  }
  if (!defect_free_ && !is_defect_free_too_large_) {
    auto rays =
        std::make_shared<const CornerRays>(trace_corner_rays(part.clean->part,
                                                             *part.clean->bvh,
                                                             {},
                                                             PinholeCamera(intrinsics_of(scene)),
                                                             camera_from_world(scene.viewpoint()),
                                                             scene.render,
                                                             pool_));
    const std::size_t bytes = bytes_of(*rays);
    if (bytes > max_bytes_ / 8) {
      is_defect_free_too_large_ = true;
      return rays;  // for this scene; made again for each they would cost what they save
    }
    defect_free_ = std::move(rays);
    traced_.set_max_bytes(max_bytes_ / 2 - bytes);
  }
  return defect_free_;
}

std::shared_ptr<const PathPicture> SceneStore::picture(const SceneSettings& scene,
                                                       const PathPreview& preview) {
  return pictures_.get({.view = picture_key(scene, scene.viewpoint())}, [&] {
    check_files(scene);
    const PathView view(scene, build_defects(scene), scene.viewpoint());
    return render_view(view, path_settings(scene), pool_, {}, preview);
  });
}

std::shared_ptr<const PathPicture> SceneStore::flawless_picture(
    const SceneSettings& scene, std::span<const PixelWindow> windows) {
  const PictureKey key = {.view = picture_key(scene, scene.viewpoint()),
                          .has_defects = false,
                          .windows = {windows.begin(), windows.end()}};
  return pictures_.get(key, [&] {
    check_files(scene);
    const PathView view(scene, build_defects(scene), scene.viewpoint(), false);
    PathSettings paths = path_settings(scene);
    paths.relative_error = 0.0;  // a few windows are no picture whose mean brightness counts
    return render_view(view, paths, pool_, windows);
  });
}

std::shared_ptr<const WallView> SceneStore::intersect(
    const std::shared_ptr<const TracedScene>& traced,
    const CornerRays& rays,
    const Tunnel& tunnel) {
  const WallKey key = {.rays = {.traced = traced, .rays = &rays},
                       .tunnel = wall_key(tunnel.settings())};
  const std::shared_ptr<const IntersectedWall> known = walls_.find(key);
  if (known && known->view) {
    return known->view;
  }
  auto view = std::make_shared<const WallView>(rays, tunnel, traced->camera_in_world_mm);
  ++num_intersected_;
  walls_.put(key, {.view = known ? view : nullptr});
  return view;
}

std::size_t bytes_of(const TracedScene& traced) {
  std::size_t bytes = bytes_of(traced.rays) + bytes_of(traced.corners);
  for (const RayCache& rays : traced.flawless) {
    bytes += bytes_of(rays);
  }
  for (const CornerRays& rays : traced.flawless_corners) {
    bytes += bytes_of(rays);
  }
  return bytes;
}

SceneSettings first_view(SceneStore& store, SceneSettings scene) {
  if (scene.viewpoint_set.source != ViewpointSource::kListed) {
    scene.viewpoints = viewpoints_of(scene, store.build(scene)->part);
    scene.viewpoint_set = {};
  }
  return scene;
}

void check_part_in_tunnel(SceneStore& store, const SceneSettings& scene) {
  if (scene.has_tunnel) {
    check_part_in_tunnel(*store.build(scene), Tunnel(scene.tunnel), scene.scan, scene.tunnel_name);
  }
}

void check_cameras_outside_part(SceneStore& store, const SceneSettings& scene) {
  const Part& part = store.build(scene)->part;
  const std::vector<Viewpoint> viewpoints = viewpoints_of(scene, part);
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    check_camera_outside_part(scene.camera, viewpoints[i], i, part.mesh);
  }
}

}  // namespace glint

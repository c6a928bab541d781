// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/scene_store.h"

#include <algorithm>
#include <variant>

#include <unistd.h>

#include "core/file.h"
#include "core/text.h"

namespace glint {
namespace {

constexpr std::size_t kKeptParts = 2;
constexpr std::size_t kKeptDefects = 4;
constexpr std::size_t kKeptScenes = 3;

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

/// Moves the entry of that key to the front; nullptr when there is none.
template <class List>
auto find_and_touch(List& list, const std::string& key) {
  const auto found =
      std::ranges::find_if(list, [&](const auto& entry) { return entry.key == key; });
  if (found == list.end()) {
    return decltype(found->value)();
  }
  list.splice(list.begin(), list, found);
  return list.front().value;
}

/// Puts a new entry first and drops the oldest beyond a number.
template <class List, class Value>
void keep_first(List& list, const std::string& key, Value value, std::size_t most) {
  list.push_front({key, std::move(value)});
  if (list.size() > most) {
    list.pop_back();
  }
}

/// What of [render] tracing depends on.
SceneSettings as_traced(SceneSettings scene) {
  using Method = RenderSettings::Method;
  const RenderSettings defaults;
  if (scene.render.method == Method::kSampled) {
    scene.render.max_direction_error_rad = defaults.max_direction_error_rad;
  } else {
    // Masks and distances of a path-traced scene come from the same rays, its light does not.
    scene.render.method = needs_paths(scene) ? Method::kPaths : Method::kIntegrated;
    scene.render.rays_per_axis = defaults.rays_per_axis;
  }
  if (scene.render.method == Method::kPaths) {
    scene.render.reflectance = defaults.reflectance;
  }
  return scene;
}

}  // namespace

void SceneStore::check_file(const std::filesystem::path& file) {
  if (file.empty()) {
    return;
  }
  const std::string digest = sha256_hex(read_file(file));
  const auto [known, is_new] = digests_.emplace(file.string(), digest);
  if (!is_new && known->second != digest) {
    throw IoError(file.string() +
                  ": has changed while the study was running; start again in a new folder");
  }
}

std::shared_ptr<const BuiltPart> SceneStore::build(const SceneSettings& scene) {
  const std::string key = part_key(scene.part);
  const std::scoped_lock lock(mutex_);
  if (auto known = find_and_touch(parts_, key)) {
    return known;
  }
  check_file(scene.part.file);
  auto built = std::make_shared<const BuiltPart>(build_part_with_bvh(scene.part));
  keep_first(parts_, key, built, kKeptParts);
  return built;
}

std::shared_ptr<const BuiltDefects> SceneStore::build_defects(const SceneSettings& scene) {
  auto clean = build(scene);
  const std::string key = defects_key(scene);
  const std::string key_of_maker = maker_key(scene);
  // One part at a time: candidates that differ in their lighting alone wait for the same one.
  const std::scoped_lock lock(defects_mutex_);
  auto known = find_and_touch(defects_, key);
  if (known && known->clean == clean) {
    return known;
  }
  auto maker = find_and_touch(makers_, key_of_maker);
  if (!maker || maker->part() != &clean->part) {
    maker = std::make_shared<const DefectMaker>(defect_maker(scene, clean));
    keep_first(makers_, key_of_maker, maker, kKeptParts);
  }
  auto made = std::make_shared<const BuiltDefects>(glint::build_defects(
      scene, std::move(clean), *maker, static_cast<std::uint64_t>(scene.imprint.seed)));
  ++num_defects_made_;
  keep_first(defects_, key, made, kKeptDefects);
  return made;
}

std::shared_ptr<const TracedScene> SceneStore::trace(const SceneSettings& wanted) {
  const SceneSettings scene = as_traced(wanted);
  auto part = build_defects(scene);
  const std::string key = trace_key(scene);
  // One scene at a time: tracing uses all threads of the pool anyway.
  const std::scoped_lock lock(mutex_);
  auto known = find_and_touch(traced_, key);
  if (known && known->part == part) {
    return known;
  }
  const std::shared_ptr<const CornerRays> bare = bare_rays(scene, *part);
  auto traced =
      std::make_shared<const TracedScene>(trace_scene(scene, std::move(part), bare.get(), pool_));
  ++num_traced_;
  num_retraced_ += bare ? 1 : 0;
  traced_.push_front({key, traced});
  drop_beyond_limit();
  return traced;
}

/// From the second set of defects for one camera on, the rays without any are worth having.
std::shared_ptr<const CornerRays> SceneStore::bare_rays(const SceneSettings& scene,
                                                        const BuiltDefects& part) {
  if (scene.render.method == RenderSettings::Method::kSampled || needs_paths(scene) ||
      scene.defects.empty() || part.built != part.clean) {
    return nullptr;
  }
  SceneSettings bare = scene;
  bare.defects.clear();
  bare.imprint = {};
  bare.metrics = {};
  const std::string key = trace_key(bare);
  if (bare_key_ != key) {
    bare_key_ = key;
    bare_.reset();
    return nullptr;
  }
  if (!bare_) {
    auto rays =
        std::make_shared<const CornerRays>(trace_corner_rays(part.clean->part,
                                                             *part.clean->bvh,
                                                             {},
                                                             PinholeCamera(intrinsics_of(scene)),
                                                             camera_from_world(scene.viewpoint()),
                                                             scene.render,
                                                             pool_));
    if (bytes_of(*rays) > most_bytes_ / 8) {
      return nullptr;
    }
    bare_ = std::move(rays);
  }
  return bare_;
}

/// The files that pictures are made of.
void SceneStore::check_files(const SceneSettings& scene) {
  const std::scoped_lock lock(mutex_);
  for (const std::filesystem::path& file : input_files(scene)) {
    check_file(file);
  }
}

SceneSettings first_view(SceneStore& store, SceneSettings scene) {
  if (scene.viewpoint_set.source != ViewpointSource::kListed) {
    scene.viewpoints = {viewpoints_of(scene, store.build(scene)->part).front()};
    scene.viewpoint_set = {};
  }
  return scene;
}

std::shared_ptr<const PathPicture> SceneStore::picture(const SceneSettings& scene,
                                                       const PathPreview& preview) {
  return pictures_.get(picture_key(scene, scene.viewpoint()), [&] {
    check_files(scene);
    const PathView view(scene, build_defects(scene), scene.viewpoint());
    return render_view(view, path_settings(scene), pool_, {}, preview);
  });
}

std::shared_ptr<const PathPicture> SceneStore::flawless_picture(
    const SceneSettings& scene, std::span<const PixelWindow> windows) {
  std::string key = picture_key(scene, scene.viewpoint()) + "flawless";
  KeyDigest digest(key);
  for (PixelWindow window : windows) {
    digest.integer("left_px", window.left_px, {}, "");
    digest.integer("top_px", window.top_px, {}, "");
    digest.integer("width_px", window.width_px, {}, "");
    digest.integer("height_px", window.height_px, {}, "");
  }
  return pictures_.get(key, [&] {
    check_files(scene);
    const PathView view(scene, build_defects(scene), scene.viewpoint(), false);
    PathSettings paths = path_settings(scene);
    paths.relative_error = 0.0;  // a few windows are no picture whose mean brightness counts
    return render_view(view, paths, pool_, windows);
  });
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

SceneStore::SceneStore(ThreadPool& pool, std::size_t most_bytes)
    : pool_(pool),
      most_bytes_(most_bytes > 0 ? most_bytes : machine_bytes() / 4),
      pictures_(most_bytes_ / 2) {}

std::size_t SceneStore::kept_bytes() const {
  std::size_t bytes = 0;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& entry : traced_) {
      bytes += bytes_of(*entry.value);
    }
    bytes += bare_ ? bytes_of(*bare_) : 0;
  }
  const std::scoped_lock lock(walls_mutex_);
  for (const MetWall& wall : walls_) {
    bytes += wall.value ? wall.value->bytes() : 0;
  }
  return bytes + pictures_.kept_bytes();
}

/// Old scenes go, and with each of them its walls; half of the limit is left to walls.
void SceneStore::drop_beyond_limit() {
  std::size_t bytes = bare_ ? bytes_of(*bare_) : 0;
  std::size_t kept = 0;
  for (const auto& entry : traced_) {
    bytes += bytes_of(*entry.value);
    if (kept > 0 && (kept == kKeptScenes || bytes > most_bytes_ / 2)) {
      break;
    }
    ++kept;
  }
  traced_.resize(kept);
  const std::scoped_lock lock(walls_mutex_);
  const auto is_dropped = [&](const auto& made_for) {
    return std::ranges::none_of(traced_, [traced = made_for.traced.lock()](const auto& entry) {
      return entry.value == traced;
    });
  };
  std::erase_if(walls_, is_dropped);
}

std::shared_ptr<const WallView> SceneStore::meet(const std::shared_ptr<const TracedScene>& traced,
                                                 const CornerRays& rays,
                                                 const Tunnel& tunnel) {
  const std::string key = wall_key(tunnel.settings());
  const auto is_wanted = [&](const MetWall& wall) {
    return wall.rays == &rays && wall.key == key && wall.traced.lock() == traced;
  };
  bool was_asked_for = false;
  {
    const std::scoped_lock lock(walls_mutex_);
    const auto found = std::ranges::find_if(walls_, is_wanted);
    was_asked_for = found != walls_.end();
    if (was_asked_for) {
      walls_.splice(walls_.begin(), walls_, found);
      if (walls_.front().value) {
        return walls_.front().value;
      }
    }
  }
  auto view = std::make_shared<const WallView>(rays, tunnel, traced->camera_in_world_mm);
  ++num_met_;
  const std::scoped_lock lock(walls_mutex_);
  std::erase_if(walls_, is_wanted);
  walls_.push_front({key, &rays, traced, was_asked_for ? view : nullptr});
  std::size_t bytes = 0;
  std::size_t kept = 0;
  for (const MetWall& wall : walls_) {
    bytes += wall.value ? wall.value->bytes() : 0;
    if (kept == kKeptWalls || bytes > most_bytes_ / 2) {
      break;
    }
    ++kept;
  }
  walls_.resize(kept);
  return view;
}

void check_part_in_tunnel(SceneStore& store, const SceneSettings& scene) {
  if (scene.has_tunnel) {
    check_part_in_tunnel(*store.build(scene), Tunnel(scene.tunnel), scene.scan, scene.tunnel_name);
  }
}

}  // namespace glint

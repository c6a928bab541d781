// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/geometry_passes.h"

#include <chrono>
#include <system_error>

#include <fmt/format.h>

#include "core/error.h"
#include "core/wall_clock.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/definition/scene_file.h"
#include "studies/imaging/geometry/view_geometry.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// Places and normals are means over a pixel: to a tenth of it.
constexpr int kSamples = 16;

std::string missing_sentence(const fs::path& scene, const std::string& why) {
  return fmt::format(
      "{} has no geometry.exr, and {}: edges have no names, and no cause of pose, "
      "lens or camera is named.",
      (scene.filename() == "scene.toml" ? scene.parent_path() : scene).string(),
      why);
}

/// A view whose folder has a scene but no geometry.
bool lacks_geometry(const CompareSource& source) {
  return !source.scene.empty() && source.geometry.empty();
}

}  // namespace

GeometryPasses::GeometryPasses(SceneStore& store, std::span<const ComparePair> pairs)
    : store_(store) {
  for (const ComparePair& pair : pairs) {
    if (lacks_geometry(pair.simulated)) {
      ++to_come_[pair.simulated.scene];
    }
  }
}

std::string GeometryPasses::complete(ComparedPair& pair) {
  CompareSource& source = pair.simulated.source;
  const OutlinePair& outlines = pair.geometry.outlines;
  if (!lacks_geometry(source) || outlines.simulated.located.empty() ||
      outlines.real.located.empty()) {
    return "";
  }
  auto found = made_.find(source.scene);
  if (found == made_.end()) {
    found = made_.emplace(source.scene, make(pair.simulated)).first;
  }
  source.geometry = found->second.file;
  return found->second.missing;
}

void GeometryPasses::release(ComparedPair& pair) {
  CompareSource& source = pair.simulated.source;
  const auto left = to_come_.find(source.scene);
  if (left == to_come_.end()) {
    return;
  }
  source.geometry.clear();
  const auto made = made_.find(source.scene);
  if (--left->second == 0 && made != made_.end()) {
    std::error_code ignored;
    fs::remove(made->second.file, ignored);
    made_.erase(made);
  }
}

GeometryPasses::Made GeometryPasses::make(const ComparedPicture& picture) {
  const fs::path& scene = picture.source.scene;
  const auto start = std::chrono::steady_clock::now();
  Made made;
  try {
    const CameraSettings camera = load_scene(scene).camera;
    if (camera.width_px == picture.width() && camera.height_px == picture.height()) {
      made.file = render(scene);
    } else {
      const std::string why = fmt::format(
          "its scene is of pictures of {} x {} pixels", camera.width_px, camera.height_px);
      made.missing = missing_sentence(scene, why);
    }
  } catch (const Error& error) {
    made.missing =
        missing_sentence(scene, fmt::format("its scene cannot be rendered ({})", error.what()));
  }
  render_s_ += seconds_since(start);
  return made;
}

fs::path GeometryPasses::render(const fs::path& scene) {
  if (!folder_) {
    folder_.emplace("the geometry of views");
  }
  fs::path file = folder_->path() / fmt::format("geometry_{}.exr", num_rendered_++);
  write_geometry(render_geometry(store_, load_scene(scene), kSamples), file);
  return file;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/geometry_passes.h"

#include <chrono>

#include <fmt/format.h>

#include "core/error.h"
#include "core/wall_clock.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/imaging/scene_store.h"
#include "studies/imaging/view_geometry.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// Places and normals are means over a pixel: to a tenth of it.
constexpr int kSamples = 16;

std::string missing_sentence(const fs::path& scene, const std::string& why) {
  return fmt::format(
      "{} has no geometry.exr, and {}: edges have no names, and no cause of pose, "
      "lens or camera is told.",
      scene.parent_path().string(),
      why);
}

}  // namespace

std::string GeometryPasses::complete(ComparedPicture& picture) {
  CompareSource& source = picture.source;
  if (source.scene.empty() || !source.geometry.empty()) {
    return "";
  }
  auto found = made_.find(source.scene);
  if (found == made_.end()) {
    found = made_.emplace(source.scene, make(picture)).first;
  }
  source.geometry = found->second.file;
  return found->second.missing;
}

GeometryPasses::Made GeometryPasses::make(const ComparedPicture& picture) {
  const fs::path& scene = picture.source.scene;
  const auto start = std::chrono::steady_clock::now();
  Made made;
  try {
    const CameraSettings camera = read_view_scene(scene).camera;
    if (camera.width_px == picture.width() && camera.height_px == picture.height()) {
      made.file = render(scene);
    } else {
      const std::string why = fmt::format(
          "its scene.toml is of pictures of {} x {} pixels", camera.width_px, camera.height_px);
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
  SceneStore store(pool_);
  const fs::path file = folder_->path() / fmt::format("geometry_{}.exr", made_.size());
  write_geometry(render_geometry(store, read_view_scene(scene), kSamples), file);
  return file;
}

}  // namespace glint

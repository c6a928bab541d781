// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/front/front_files.h"

#include <algorithm>
#include <set>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/image_io.h"
#include "studies/output/output_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr int kThumbnailWidth_px = 240;

bool is_full(const fs::path& folder) {
  return fs::exists(folder / "scores.json") || fs::exists(folder / "sequence");
}

/// Folders of the designs that are shown so ("full", or not), of those that have one.
std::set<fs::path> folders_of(const fs::path& run, const Json& front, bool is_shown_full) {
  std::set<fs::path> folders;
  for (const Json& design : front["designs"]) {
    if (design.contains("folder") && (design["shown"] == "full") == is_shown_full) {
      folders.insert(run / design["folder"].get<std::string>());
    }
  }
  return folders;
}

}  // namespace

void remove_other_designs(const fs::path& run, const Json& front) {
  const std::set<fs::path> full = folders_of(run, front, true);
  const std::set<fs::path> small = folders_of(run, front, false);
  std::error_code ignored;
  std::vector<fs::path> old;
  for (const fs::directory_entry& entry : fs::directory_iterator(run / kFrontFolder, ignored)) {
    const fs::path& path = entry.path();
    const bool is_ours = path.filename().string().starts_with("trial_") && entry.is_directory();
    const bool stays = full.contains(path) || (small.contains(path) && !is_full(path));
    if (is_ours && !stays) {
      old.push_back(path);
    } else if (full.contains(path)) {
      fs::remove(path / "thumbnail.png", ignored);
    }
  }
  for (const fs::path& path : old) {
    fs::remove_all(path);
  }
  if (fs::is_empty(run / kFrontFolder, ignored)) {
    fs::remove(run / kFrontFolder, ignored);
  }
}

void write_thumbnail(SceneStore& store,
                     const SceneSettings& wanted_scene,
                     const std::string& title,
                     const WantedScores& wanted,
                     const DrawLighting& drawing,
                     const fs::path& folder) {
  const SceneSettings scene = first_view(store, wanted_scene);
  make_folder(folder);
  remove_unfinished_files(folder);
  const Evaluation evaluation = evaluate(store, scene, {}, wanted.of_one_scan());
  const ImageF& aspect = evaluation.aspect;
  const int factor = std::max(1, (aspect.width() + kThumbnailWidth_px - 1) / kThumbnailWidth_px);
  write_png(folder / "thumbnail.png", reduce(aspect, factor), PixelDepth::k8Bit);
  write_file(folder / "scene.toml", to_toml(write_scene(scene)));
  write_file(folder / "cross_section.svg", drawing(scene, evaluation, title));
}

}  // namespace glint

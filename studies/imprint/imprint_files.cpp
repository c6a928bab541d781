// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imprint/imprint_files.h"

#include <algorithm>
#include <chrono>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/image_io.h"
#include "core/wall_clock.h"
#include "defects/part/defect_files.h"
#include "defects/part/defect_metadata.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxTiles = 96;

/// Defects that are no triangles: by their normals, and stains.
SurfaceDetail shapeless_detail(const DefectivePart& made) {
  std::set<int> shapeless;
  for (const RealisedDefect& defect : made.defects) {
    if (defect.is_made && defect.defect.realisation == Realisation::kNormal) {
      shapeless.insert(defect.defect.id);
    }
  }
  std::vector<HeightFeature> features;
  for (const HeightFeature& outline : made.outlines) {
    if (shapeless.contains(outline.id)) {
      features.push_back(outline);
    }
  }
  return SurfaceDetail(std::move(features));
}

PreviewView view_of(const Defect& defect, const Bvh& bvh) {
  const bool is_drawn_out = is_line(defect.type);
  return place_view(bvh,
                    defect.place,
                    {.along_mm = is_drawn_out ? defect.length_mm : defect.diameter_mm,
                     .across_mm = is_drawn_out ? defect.width_mm : defect.diameter_mm,
                     .height_mm = defect.type == DefectType::kBump ? defect.depth_mm : 0.0});
}

/// What a reader of the files should know.
Json notes_of(const DefectivePart& made, const FloatLoss& loss) {
  Json notes = Json::array();
  if (made.defects.empty()) {
    notes.push_back("the part has no defect: every count is 0 and no place is given");
  }
  if (std::string note = shallow_note(made); !note.empty()) {
    notes.push_back(std::move(note));
  }
  const auto by_normals = std::ranges::count_if(made.defects, [](const RealisedDefect& defect) {
    return defect.is_made && defect.defect.realisation == Realisation::kNormal &&
           defect.defect.type != DefectType::kStain;
  });
  if (by_normals > 0) {
    notes.push_back(
        fmt::format("{} of the defects are realised by their normals: they are in metadata and "
                    "previews, not in the mesh; realisation = \"imprinted\" cuts them",
                    by_normals));
  }
  if (!loss.none()) {
    notes.push_back("part.stl: " + loss.warning());
  }
  return notes;
}

/// File names as they stand in the scene, so that the metadata does not depend on where that lies.
void name_files_as_written(const ConfigNode& scene, Json& groups) {
  for (auto& [name, table] : groups.items()) {
    for (const char* key : {"tool_folder", "region_file"}) {
      const ConfigNode* node = scene.at_path(fmt::format("defects.{}.{}", name, key));
      if (node != nullptr) {
        table[key] = node->text;
      }
    }
  }
}

/// A tile for each defect that was made, seen along its normal.
ImageF defect_sheet(const BuiltDefects& part, ThreadPool& pool) {
  const SurfaceDetail detail = shapeless_detail(part.made);
  const PreviewSubject subject = {.mesh = part.built->part.mesh,
                                  .bvh = *part.built->bvh,
                                  .labels = part.made.labels,
                                  .detail = detail};
  std::vector<ImageF> tiles;
  std::vector<int> numbers;
  for (const RealisedDefect& made : part.made.defects) {
    if (made.is_made && tiles.size() < kMaxTiles) {
      const PreviewView view = view_of(made.defect, *part.clean->bvh);
      tiles.push_back(draw_preview(subject, view, pool).image);
      numbers.push_back(made.defect.id);
    }
  }
  return contact_sheet(tiles, numbers);
}

void write_previews(const fs::path& folder,
                    const BuiltDefects& part,
                    const std::vector<PreviewView>& views,
                    ThreadPool& pool) {
  const SurfaceDetail detail = shapeless_detail(part.made);
  const PreviewSubject subject = {.mesh = part.built->part.mesh,
                                  .bvh = *part.built->bvh,
                                  .labels = part.made.labels,
                                  .detail = detail};
  for (std::size_t i = 0; i < views.size(); ++i) {
    const PreviewPictures pictures = draw_preview(subject, views[i], pool);
    write_png(folder / fmt::format("preview_image_{}.png", i), pictures.image, PixelDepth::k8Bit);
    write_png(folder / fmt::format("preview_map_{}.png", i), pictures.map, PixelDepth::k8Bit);
  }
  write_png(folder / "preview_defects.png", defect_sheet(part, pool), PixelDepth::k8Bit);
}

}  // namespace

void write_imprint_files(const fs::path& folder,
                         const SceneSettings& scene,
                         const BuiltDefects& part,
                         std::uint64_t seed,
                         const ImprintFileOptions& options,
                         ThreadPool& pool,
                         ImprintSeconds& seconds) {
  auto start = Clock::now();
  const TriangleMesh& mesh = part.built->part.mesh;
  std::vector<std::int32_t> labels = part.made.labels;
  labels.resize(mesh.num_triangles(), 0);  // empty where the part is as it was
  const FloatLoss loss = write_stl(folder / "part.stl", mesh);
  write_labelled_ply(folder / "part.ply", mesh, labels);
  write_defect_map(folder / "defect_map.obj", mesh, labels);
  Json metadata =
      defects_json(part.made, scene.defects, scene.imprint, seed, part.clean->part.scene_from_part);
  const std::vector<double> slopes_rad = defect_slopes_rad(part);
  for (std::size_t i = 0; i < slopes_rad.size(); ++i) {
    metadata["defects"][i]["max_slope_mrad"] = 1e3 * slopes_rad[i];
  }
  name_files_as_written(options.scene, metadata["groups"]);
  metadata["notes"] = notes_of(part.made, loss);
  write_file(folder / kImprintMetadata, metadata.dump(2) + "\n");
  seconds.files_s = seconds_since(start);
  if (options.has_previews) {
    start = Clock::now();
    write_previews(folder, part, options.views, pool);
    seconds.previews_s = seconds_since(start);
  }
}

Json imprint_summary(const Json& metadata) {
  int retries = 0;
  int jitters = 0;
  for (const Json& defect : metadata["defects"]) {
    retries += defect["attempts"].get<int>() - 1;
    jitters += defect["jitters"].get<int>();
  }
  return {{"made", metadata["made"]},
          {"given_up", metadata["given_up"]},
          {"retries", retries},
          {"jitters", jitters},
          {"removed_volume_mm3", metadata["removed_volume_mm3"]}};
}

Json timings_json(const ImprintSeconds& seconds, const DefectivePart& made) {
  Json defects = Json::object();
  for (const RealisedDefect& defect : made.defects) {
    defects[defect.defect.label] = defect.seconds;
  }
  return {{"make_s", seconds.make_s},
          {"files_s", seconds.files_s},
          {"previews_s", seconds.previews_s},
          {"defects", defects}};
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imprint/imprint_tools.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/image_io.h"
#include "defects/tools/tools.h"
#include "simulator/geometry/mesh_file/mesh_write.h"
#include "simulator/render/preview/preview.h"
#include "studies/imprint/imprint_folder.h"
#include "studies/output/output_folder.h"
#include "studies/output/result_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr int kToolsOfGroup = 6;  ///< a row of the sheet
constexpr double kToolCrease_rad = 40.0 * kRadPerDeg;

struct SampleTool {
  std::string name;
  const DefectGroup* group = nullptr;
  TriangleMesh mesh;
};

std::vector<SampleTool> sample_tools_of(const Study& study) {
  std::vector<SampleTool> tools;
  const auto seed = static_cast<std::uint64_t>(study.scene.imprint.seed);
  for (const auto& [name, group] : study.scene.defects) {
    if (group.type == DefectType::kStain) {
      continue;
    }
    const ToolCollection collection(name, group);
    std::vector<TriangleMesh> meshes = collection.samples(kToolsOfGroup, seed);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      tools.push_back({.name = fmt::format("{}_{}", name, i + 1),
                       .group = &group,
                       .mesh = std::move(meshes[i])});
    }
  }
  return tools;
}

/// The side that works towards the camera.
ImageF tool_tile(const SampleTool& tool, ThreadPool& pool) {
  TriangleMesh mesh = tool.mesh;
  if (tool.group->type != DefectType::kBump) {
    const Eigen::Matrix3d over = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    transform(mesh, {.rotation = over});
  }
  smooth_normals(mesh, kToolCrease_rad);
  const Bvh bvh(mesh);
  const PreviewView view = fitted_view(mesh, {-0.35, 0.6, -0.75}, kTileSide_px - 8);
  return draw_preview({.mesh = mesh, .bvh = bvh, .labels = {}, .detail = {}}, view, pool).image;
}

Json tool_json(const SampleTool& tool, int number) {
  const Eigen::Vector3d size_mm = bounding_box(tool.mesh).size_mm();
  return {{"number", number},
          {"name", tool.name},
          {"type", type_name(tool.group->type)},
          {"triangles", tool.mesh.num_triangles()},
          {"volume_mm3", enclosed_volume_mm3(tool.mesh)},
          {"size_mm", {size_mm.x(), size_mm.y(), size_mm.z()}},
          {"file", fmt::format("tools/{}.stl", tool.name)}};
}

void write_tools(const std::vector<SampleTool>& tools,
                 const fs::path& folder,
                 Json& result,
                 ThreadPool& pool) {
  std::vector<ImageF> tiles;
  std::vector<int> numbers;
  make_folder(folder / "tools");
  result["tools"] = Json::array();
  result["files"] = {"tools.json", "tools.png"};
  for (const SampleTool& tool : tools) {
    numbers.push_back(static_cast<int>(numbers.size()) + 1);
    tiles.push_back(tool_tile(tool, pool));
    Json json = tool_json(tool, numbers.back());
    write_mesh(folder / json["file"].get<std::string>(), tool.mesh);
    result["files"].push_back(json["file"]);
    result["tools"].push_back(std::move(json));
  }
  write_png(folder / "tools.png", contact_sheet(tiles, numbers), PixelDepth::k8Bit);
  write_file(folder / "tools.json", result.dump(2) + "\n");
}

}  // namespace

Json preview_tools(const Study& study, const ImprintOptions& options) {
  std::vector<SampleTool> tools;
  try {
    tools = sample_tools_of(study);
  } catch (const ConfigError& error) {
    throw with_place(study.root, error);
  }
  if (tools.empty()) {
    throw ConfigError(study.root.place.file +
                      ": defects: no table [defects.<name>] that has tools");
  }
  const std::vector<std::string> names = {"tools", "tools.json", "tools.png", "run.json"};
  check_result_folder(options.out, ResultKind::kTools, names);
  check_study_of_folder(options.out, study.name);
  check_inputs_kept(input_files(study), options.out, names);
  OutputFolder folder(options.out);
  remove_stale_stages(options.out);
  ThreadPool pool(options.threads);
  Json result = {{"schema", 1}, {"status", "done"}, {"name", study.name}};
  {
    StagedFolder stage(options.out, "");
    mark_result_folder(stage.path(),
                       ResultKind::kTools,
                       study.name,
                       source_seen_from(options.out, study.root.place.file));
    write_tools(tools, stage.path(), result, pool);
    stage.commit();
  }
  folder.keep();
  result["folder"] = options.out.string();
  return result;
}

}  // namespace glint

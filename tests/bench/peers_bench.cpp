// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one candidate lighting costs in Glint, in Blender's Cycles and in POV-Ray: same mesh, same
// image, errors of the frames against one reference (docs/benchmarks.md).
#include <malloc.h>
#include <exception>
#include <iostream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/text.h"
#include "simulator/geometry/mesh_file/mesh_write.h"
#include "tests/bench/peers/candidate.h"
#include "tests/bench/peers/cycles.h"
#include "tests/bench/peers/part_mesh.h"
#include "tests/bench/peers/povray.h"
#include "tests/bench/peers/process.h"

namespace glint::peers {
namespace {

struct Arguments {
  std::filesystem::path scene;
  std::filesystem::path folder;
  int repeats = 25;
  int reference_rays_per_axis = 16;
};

/// Reads the scene, with the mesh that lies in the folder as its part.
SceneSettings load_scene(const Arguments& arguments) {
  ConfigNode root = load_toml(arguments.scene);
  set_path(root, "part.file", ConfigNode::from_text((arguments.folder / "part.ply").string()));
  std::vector<Problem> errors;
  SceneSettings scene = read_scene(root, errors);
  if (!errors.empty()) {
    throw ConfigError(errors);
  }
  return scene;
}

void progress(const std::string& what) {
  std::cerr << "bench: " << what << std::endl;
}

/// Says what is missing. Program and Debian package have the same name.
bool is_installed(const std::string& package) {
  if (!find_program(package).empty()) {
    return true;
  }
  progress(
      fmt::format("{0} is not installed and left out; on Debian: "
                  "apt-get install --no-install-recommends {0}",
                  package));
  return false;
}

std::vector<Result> cycles_rows(const SceneSettings& scene,
                                const Part& part,
                                const Arguments& arguments) {
  const auto script = arguments.scene.parent_path() / "cycles.py";
  write_raw_meshes(arguments.folder / "part.raw", {&part.mesh, 1});
  std::vector<Result> rows;
  for (const CyclesSettings& settings : {CyclesSettings{.samples_per_pixel = 4},
                                         CyclesSettings{.samples_per_pixel = 4, .is_packed = true},
                                         CyclesSettings{.samples_per_pixel = 16}}) {
    progress(fmt::format("Cycles, {} samples a pixel", settings.samples_per_pixel));
    rows.push_back(measure_cycles(scene, settings, script, arguments.folder));
  }
  return rows;
}

std::vector<Result> povray_rows(const SceneSettings& scene,
                                const Part& part,
                                const Arguments& arguments) {
  write_povray_mesh(arguments.folder / "part.inc", part.mesh);
  std::vector<Result> rows;
  for (const PovraySettings& settings :
       {PovraySettings{.name = "r2", .threshold = 0.0, .depth = 2},
        PovraySettings{.name = "r4", .threshold = 0.1, .depth = 4}}) {
    progress(fmt::format("POV-Ray, R{}", settings.depth));
    const auto more = measure_povray(scene, settings, arguments.folder);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  return rows;
}

/// Adds a peer's rows when it is installed. A peer that fails must not keep the others from the
/// table. @return false when it failed
template <class Measure>
bool add_peer(const std::string& package, const Measure& measure, std::vector<Result>& results) {
  if (!is_installed(package)) {
    return true;
  }
  try {
    const std::vector<Result> rows = measure();
    results.insert(results.end(), rows.begin(), rows.end());
    return true;
  } catch (const std::exception& error) {
    progress(fmt::format("{} is left out: {}", package, error.what()));
    return false;
  }
}

/// A cold candidate from the mesh's file, as the processes of the peers begin with it.
Result with_reading(const Result& result, double read_s) {
  return {.tool = result.tool,
          .setting = result.setting + ", mesh read too",
          .cold_s = result.cold_s + read_s,
          .notes = fmt::format("reading the mesh and its normals takes {:.2g} s", read_s),
          .settings = result.settings};
}

/// @return false when an installed peer failed
bool run(const Arguments& arguments) {
  make_folder(arguments.folder);
  progress("writing the mesh");
  write_mesh(arguments.folder / "part.ply", make_part_mesh());
  const SceneSettings scene = load_scene(arguments);
  const double start_s = cpu_seconds();
  const Part part = build_part(scene.part);
  const double read_s = cpu_seconds() - start_s;
  progress("Glint");
  std::vector<Result> results = measure_glint(scene, part, arguments.repeats);
  results.insert(results.begin() + 1, with_reading(results.front(), read_s));
  const auto cycles = [&] { return cycles_rows(scene, part, arguments); };
  const auto povray = [&] { return povray_rows(scene, part, arguments); };
  bool is_whole = add_peer("blender", cycles, results);
  is_whole = add_peer("povray", povray, results) && is_whole;
  progress(fmt::format("reference, {0} x {0} rays a pixel", arguments.reference_rays_per_axis));
  const Reference reference = render_reference(scene, part, arguments.reference_rays_per_axis);
  write_exr(arguments.folder / "reference.exr", reference.frame);
  write_exr(arguments.folder / "glint.exr", results.front().frame);
  write_json(arguments.folder.parent_path() / "peers.json", results, reference);
  std::cout << to_table(results, reference);
  return is_whole;
}

int main_of(int argc, char** argv) {
  CLI::App app("Glint against Blender's Cycles and POV-Ray on one scene");
  Arguments arguments;
  app.add_option("SCENE", arguments.scene, "scene.toml")->required();
  app.add_option("FOLDER", arguments.folder, "for meshes and frames; peers.json beside it")
      ->required();
  app.add_option("--repeats", arguments.repeats, "of Glint's candidate")
      ->check(CLI::Range(1, 100000));
  app.add_option("--reference", arguments.reference_rays_per_axis, "rays along a pixel's side")
      ->check(CLI::Range(1, 16));
  CLI11_PARSE(app, argc, argv);
  arguments.scene = std::filesystem::absolute(arguments.scene);
  arguments.folder = std::filesystem::absolute(arguments.folder);
  return run(arguments) ? 0 : 1;
}

}  // namespace
}  // namespace glint::peers

int main(int argc, char** argv) {
  // As the program does: memory of one candidate serves the next.
  mallopt(M_MMAP_THRESHOLD, 1 << 28);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  try {
    return glint::peers::main_of(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "bench: " << error.what() << "\n";
    return 1;
  }
}

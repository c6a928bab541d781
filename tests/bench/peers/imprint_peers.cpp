// SPDX-License-Identifier: GPL-3.0-or-later
//
// What imprinting the same tools one by one costs in Glint and in Blender's Boolean modifier, by
// its EXACT and its FAST solver (docs/benchmarks.md). Same meshes in floats, one thread.
#include <iostream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "defects/boolean/imprint.h"
#include "tests/bench/peers/part_mesh.h"
#include "tests/bench/peers/process.h"
#include "tests/defects/boolean/imprint_support.h"

namespace glint::peers {
namespace {

using nlohmann::ordered_json;

struct Case {
  double edge_mm = 0.0;  ///< of the gear's triangles
  int tools = 0;
  double goal = 0.0;  ///< times Blender's EXACT; 0: none is set
};

/// Coordinates as Blender keeps them.
TriangleMesh in_floats(TriangleMesh mesh) {
  for (Eigen::Vector3d& point : mesh.vertices_mm) {
    point = point.cast<float>().cast<double>();
  }
  return mesh;
}

std::vector<TriangleMesh> mixed_tools(const TriangleMesh& part, int count) {
  const imprint_support::Places places(part);
  const double size_mm = bounding_box(part).size_mm().norm();
  std::vector<TriangleMesh> tools;
  for (int i = 0; i < count; ++i) {
    tools.push_back(in_floats(imprint_support::mixed_tool(places, size_mm, 1, i)));
  }
  return tools;
}

struct Cost {
  double cpu_s = 0.0;
  double removed_mm3 = 0.0;
};

Cost imprint_with_glint(const TriangleMesh& part, const std::vector<TriangleMesh>& tools) {
  Cost cost;
  const double start_s = cpu_seconds();
  ImprintedMesh imprinted(part);
  std::int32_t label = 0;
  for (const TriangleMesh& tool : tools) {
    cost.removed_mm3 +=
        imprinted.imprint(tool, ++label, ImprintOperation::kSubtract, {.may_break_through = true})
            .removed_volume_mm3;
  }
  cost.cpu_s = cpu_seconds() - start_s;
  return cost;
}

Cost imprint_with_blender(const std::string& solver,
                          std::size_t tools,
                          const std::filesystem::path& meshes,
                          const std::filesystem::path& script,
                          const std::filesystem::path& folder) {
  const auto job_file = folder / (solver + "_job.json");
  const auto result = folder / (solver + "_result.json");
  const ordered_json job = {{"meshes", meshes.string()},
                            {"result", result.string()},
                            {"solver", solver},
                            {"tools", tools}};
  write_file(job_file, job.dump(2) + "\n");
  run_blender(script, job_file, folder, folder / (solver + ".log"));
  const auto read = nlohmann::json::parse(read_file(result));
  return {.cpu_s = read.at("cpu_s").get<double>(),
          .removed_mm3 = read.at("removed_mm3").get<double>()};
}

void print_row(const std::string& tool, const Cost& cost, const Cost& glint) {
  fmt::print("  {:<14} {:>9.3f} s {:>9.1f} x Glint   removed {:.6g} mm3\n",
             tool,
             cost.cpu_s,
             cost.cpu_s / glint.cpu_s,
             cost.removed_mm3);
}

ordered_json compare(const Case& wanted,
                     const std::filesystem::path& script,
                     const std::filesystem::path& folder) {
  const TriangleMesh part = in_floats(imprint_support::gear(wanted.edge_mm));
  const std::vector<TriangleMesh> tools = mixed_tools(part, wanted.tools);
  const auto meshes = folder / "meshes.raw";
  std::vector<TriangleMesh> written = {part};
  written.insert(written.end(), tools.begin(), tools.end());
  write_raw_meshes(meshes, written);
  const Cost glint = imprint_with_glint(part, tools);
  fmt::print("{} triangles, {} tools one by one, CPU time on one thread, reading not counted:\n",
             part.num_triangles(),
             tools.size());
  print_row("Glint", glint, glint);
  ordered_json row = {{"triangles", part.num_triangles()},
                      {"tools", tools.size()},
                      {"glint_s", glint.cpu_s},
                      {"glint_removed_mm3", glint.removed_mm3}};
  for (const char* solver : {"FAST", "EXACT"}) {
    const Cost cost = imprint_with_blender(solver, tools.size(), meshes, script, folder);
    print_row(fmt::format("Blender {}", solver), cost, glint);
    row[fmt::format("{}_s", solver)] = cost.cpu_s;
    row[fmt::format("{}_removed_mm3", solver)] = cost.removed_mm3;
    row[fmt::format("{}_ratio", solver)] = cost.cpu_s / glint.cpu_s;
  }
  if (wanted.goal > 0.0) {
    fmt::print("  goal: EXACT at least {:g} x Glint\n", wanted.goal);
    row["goal_ratio"] = wanted.goal;
  }
  return row;
}

int run(int argc, char** argv) {
  std::filesystem::path script;
  std::filesystem::path folder;
  CLI::App app("Imprints in Glint and in Blender", "glint_imprint_peers");
  app.add_option("SCRIPT", script, "booleans.py")->required()->check(CLI::ExistingFile);
  app.add_option("FOLDER", folder, "for jobs, meshes and logs")->required();
  CLI11_PARSE(app, argc, argv);
  if (find_program("blender").empty()) {
    fmt::print("blender is not installed (Debian's package blender): nothing to compare with\n");
    return 0;
  }
  std::filesystem::create_directories(folder);
  ordered_json rows = ordered_json::array();
  // The gear's edges give about 50,000 and 500,000 triangles.
  for (const Case& wanted : {Case{.edge_mm = 1.69, .tools = 50, .goal = 30.0},
                             Case{.edge_mm = 0.528, .tools = 10, .goal = 200.0}}) {
    rows.push_back(compare(wanted, script, folder));
  }
  write_file(folder / "imprint.json", rows.dump(2) + "\n");
  return 0;
}

}  // namespace
}  // namespace glint::peers

int main(int argc, char** argv) {
  try {
    return glint::peers::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}

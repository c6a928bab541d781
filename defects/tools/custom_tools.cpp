// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/tools/custom_tools.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "core/error.h"
#include "defects/boolean/imprint_checks.h"
#include "simulator/geometry/mesh_file/mesh_io.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 4> kExtensions = {".stl", ".ply", ".obj", ".off"};

bool is_tool(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::vector<std::filesystem::path> tool_files(const std::string& key,
                                              const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  std::filesystem::directory_iterator at(folder, error);
  for (; !error && at != std::filesystem::directory_iterator(); at.increment(error)) {
    std::error_code no_file;
    if (at->is_regular_file(no_file) && is_tool(at->path())) {
      files.push_back(at->path());
    }
  }
  if (error) {
    throw ConfigError(key,
                      fmt::format("cannot read the folder {}: {}, must be a folder of tools",
                                  folder.string(),
                                  error.message()));
  }
  if (files.empty()) {
    throw ConfigError(key,
                      fmt::format("{} holds no tool, must hold closed meshes (.stl, .ply, .obj, "
                                  ".off)",
                                  folder.string()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string place_fault(const TriangleMesh& mesh) {
  const BoundingBox box = bounding_box(mesh);
  if (box.min_mm.z() >= 0.0) {
    return fmt::format(
        "nothing of it lies below its surface z = 0 (its lowest point has z = {} mm)",
        box.min_mm.z());
  }
  if (box.max_mm.z() <= 0.0) {
    return fmt::format(
        "nothing of it lies above its surface z = 0 (its highest point has z = {} mm)",
        box.max_mm.z());
  }
  return {};
}

TriangleMesh read_tool(const std::string& key, const std::filesystem::path& file) {
  TriangleMesh mesh;
  try {
    mesh = read_mesh(file);
  } catch (const Error& error) {
    throw ConfigError(key, error.what());
  }
  std::string fault = tool_fault(mesh);
  if (fault.empty()) {
    fault = place_fault(mesh);
  }
  if (!fault.empty()) {
    throw ConfigError(key, fmt::format("{}: cannot be a tool: {}", file.string(), fault));
  }
  return mesh;
}

/// Everything above z = 0 drawn out so that it reaches that high.
TriangleMesh lifted(TriangleMesh mesh, double top_mm) {
  const double top = bounding_box(mesh).max_mm.z();
  for (Eigen::Vector3d& p : mesh.vertices_mm) {
    p.z() *= p.z() > 0.0 ? top_mm / top : 1.0;
  }
  return mesh;
}

}  // namespace

std::vector<CustomTool> read_custom_tools(const std::string& key,
                                          const std::filesystem::path& folder) {
  std::vector<CustomTool> tools;
  for (const std::filesystem::path& file : tool_files(key, folder)) {
    tools.push_back({.name = file.filename().string(), .mesh = read_tool(key, file)});
  }
  return tools;
}

TriangleMesh scaled_tool(const TriangleMesh& mesh, const CustomToolSize& size) {
  const BoundingBox box = bounding_box(mesh);
  const Eigen::Vector3d extent = box.size_mm();
  const Eigen::Vector3d centre = box.centre_mm();
  const double largest = std::max(extent.x(), extent.y());
  const double x_scale = size.is_line ? size.along_mm / extent.x() : size.across_mm / largest;
  const double y_scale = size.is_line ? size.across_mm / extent.y() : x_scale;
  TriangleMesh scaled = {.vertices_mm = mesh.vertices_mm, .triangles = mesh.triangles};
  for (Eigen::Vector3d& p : scaled.vertices_mm) {
    const double share = p.z() / -box.min_mm.z();
    p = {x_scale * (p.x() - centre.x()), y_scale * (p.y() - centre.y()), size.depth_mm * share};
  }
  const double top = 0.5 * size.across_mm;
  if (bounding_box(scaled).max_mm.z() < top) {
    TriangleMesh high = lifted(scaled, top);
    if (tool_fault(high).empty()) {
      return high;
    }
  }
  return scaled;
}

}  // namespace glint

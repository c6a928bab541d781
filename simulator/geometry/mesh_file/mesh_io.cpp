// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh_file/mesh_io.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/error.h"
#include "core/file.h"
#include "simulator/geometry/mesh_file/read_cao.h"
#include "simulator/geometry/mesh_file/read_obj_off.h"
#include "simulator/geometry/mesh_file/read_ply.h"
#include "simulator/geometry/mesh_file/read_stl.h"

namespace glint {
namespace {

std::string lower_extension(const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  std::ranges::transform(extension, extension.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return extension;
}

bool looks_like_ply(std::string_view bytes) {
  return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

/// Content first: files get wrong names. OBJ has no mark of its own, so its name must tell.
TriangleMesh parse_by_content(std::string_view bytes, const std::string& name) {
  const std::string extension = lower_extension(name);
  if (looks_like_ply(bytes)) {
    return mesh_file::read_ply(bytes, name);
  }
  if (mesh_file::looks_like_off(bytes)) {
    return mesh_file::read_off(bytes, name);
  }
  if (mesh_file::looks_like_cao(bytes)) {
    return mesh_file::read_cao(bytes, name);
  }
  if (mesh_file::looks_like_stl(bytes) || extension == ".stl") {
    return mesh_file::read_stl(bytes, name);
  }
  if (extension == ".obj") {
    return mesh_file::read_obj(bytes, name);
  }
  const bool is_named = extension == ".ply" || extension == ".off" || extension == ".cao";
  throw ConfigError(fmt::format("{}: {}; allowed: STL, PLY, OBJ, OFF, CAO",
                                name,
                                is_named ? "does not begin as a " + extension + " file must"
                                         : "is no mesh format that Glint knows"));
}

/// Whether any triangle is more than a line, as far as floats tell.
bool has_area(const TriangleMesh& mesh) {
  constexpr double kRounding_rad = 1e-7;
  return std::ranges::any_of(mesh.triangles, [&](const Triangle& triangle) {
    const auto corner = [&](std::size_t i) -> const Eigen::Vector3d& {
      return mesh.vertices_mm[static_cast<std::size_t>(triangle[i])];
    };
    const Eigen::Vector3d a = (corner(1) - corner(0)).stableNormalized();
    const Eigen::Vector3d b = (corner(2) - corner(0)).stableNormalized();
    return a.cross(b).norm() > kRounding_rad;
  });
}

}  // namespace

TriangleMesh parse_mesh(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) {
    throw ConfigError(fmt::format("{}: the file is empty", name));
  }
  TriangleMesh mesh = parse_by_content(bytes, name);
  if (mesh.triangles.empty()) {
    throw ConfigError(fmt::format("{}: it holds no triangle", name));
  }
  weld(mesh);
  if (!has_area(mesh)) {
    throw ConfigError(fmt::format("{}: all its triangles are lines or points", name));
  }
  return mesh;
}

std::vector<std::array<std::uint8_t, 3>> read_face_colours(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string bytes = read_file(path);
  if (!looks_like_ply(bytes)) {
    throw ConfigError(fmt::format("{}: is no PLY file; face colours are read from PLY", name));
  }
  std::vector<std::array<std::uint8_t, 3>> colours;
  TriangleMesh mesh = mesh_file::read_ply(bytes, name, colours);
  // Welding drops triangles that are lines or points; what it keeps carries its number in `patch`.
  mesh.patch.resize(mesh.num_triangles());
  std::iota(mesh.patch.begin(), mesh.patch.end(), std::int32_t{0});
  weld(mesh);
  std::vector<std::array<std::uint8_t, 3>> kept;
  kept.reserve(mesh.patch.size());
  for (const std::int32_t triangle : mesh.patch) {
    kept.push_back(colours[static_cast<std::size_t>(triangle)]);
  }
  return kept;
}

TriangleMesh read_mesh(const std::filesystem::path& path) {
  return parse_mesh(read_file(path), path.string());
}

TriangleMesh read_ply_with_values(const std::filesystem::path& path,
                                  std::string_view property,
                                  std::vector<std::int32_t>& values) {
  const std::string bytes = read_file(path);
  if (!looks_like_ply(bytes)) {
    throw ConfigError(fmt::format("{}: does not begin as a .ply file must", path.string()));
  }
  values.clear();
  TriangleMesh mesh = mesh_file::read_ply(bytes, path.string(), property, values);
  if (mesh.triangles.empty()) {
    throw ConfigError(fmt::format("{}: it holds no triangle", path.string()));
  }
  return mesh;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh_file/mesh_io.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "simulator/geometry/mesh_file/mesh_soup.h"

namespace glint {
namespace mesh_file {
namespace {

/// Corners are numbered with 32 bits, three a triangle.
constexpr std::size_t kMaxTriangles = std::numeric_limits<std::int32_t>::max() / 3;

}  // namespace

void check_count(std::int64_t count,
                 std::size_t bytes_each,
                 std::size_t bytes_left,
                 std::string_view what,
                 const Place& place) {
  if (count < 0 || static_cast<std::uint64_t>(count) > bytes_left / bytes_each + 1) {
    throw ConfigError(fmt::format("{}{} {} are promised, but only {} bytes are left",
                                  place.prefix(),
                                  count,
                                  what,
                                  bytes_left));
  }
}

void Soup::reserve(std::size_t vertices, std::size_t triangles) {
  mesh_.vertices_mm.reserve(vertices);
  mesh_.triangles.reserve(triangles);
}

void Soup::add_vertex(const Eigen::Vector3d& vertex, const Place& place) {
  if (!vertex.allFinite()) {
    throw ConfigError(fmt::format("{}vertex {} is not finite ({} {} {})",
                                  place.prefix(),
                                  num_vertices(),
                                  vertex.x(),
                                  vertex.y(),
                                  vertex.z()));
  }
  mesh_.vertices_mm.push_back(vertex);
}

void Soup::add_polygon(std::span<const std::int64_t> corners, const Place& place) {
  if (corners.size() < 3) {
    throw ConfigError(fmt::format("{}face {} has {} corners; allowed: 3 or more",
                                  place.prefix(),
                                  num_polygons_,
                                  corners.size()));
  }
  const auto [smallest, largest] = std::ranges::minmax(corners);
  if (smallest < 0 || largest > std::numeric_limits<std::int32_t>::max()) {
    throw ConfigError(fmt::format("{}face {} names vertex {}, which cannot be",
                                  place.prefix(),
                                  num_polygons_,
                                  smallest < 0 ? smallest : largest));
  }
  if (largest > largest_corner_) {
    largest_corner_ = largest;
    largest_corner_face_ = num_polygons_;
    largest_corner_place_ = place;
  }
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    mesh_.triangles.push_back({static_cast<std::int32_t>(corners[0]),
                               static_cast<std::int32_t>(corners[i]),
                               static_cast<std::int32_t>(corners[i + 1])});
  }
  if (mesh_.triangles.size() > kMaxTriangles) {
    throw ConfigError(
        fmt::format("{}more than {} triangles cannot be handled", place.prefix(), kMaxTriangles));
  }
  ++num_polygons_;
}

TriangleMesh Soup::take() {
  if (largest_corner_ >= num_vertices()) {
    throw ConfigError(
        fmt::format("{}face {} names vertex {} (counted from 0), but there are only {}",
                    largest_corner_place_.prefix(),
                    largest_corner_face_,
                    largest_corner_,
                    num_vertices()));
  }
  return std::move(mesh_);
}

}  // namespace mesh_file

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
  if (mesh_file::looks_like_stl(bytes) || extension == ".stl") {
    return mesh_file::read_stl(bytes, name);
  }
  if (extension == ".obj") {
    return mesh_file::read_obj(bytes, name);
  }
  const bool is_named = extension == ".ply" || extension == ".off";
  throw ConfigError(fmt::format("{}: {}; allowed: STL, PLY, OBJ, OFF",
                                name,
                                is_named ? "does not begin as a " + extension + " file must"
                                         : "is no mesh format that Glint knows"));
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
  if (mesh.triangles.empty()) {
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh_file/mesh_soup.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace glint::mesh_file {
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

}  // namespace glint::mesh_file

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::geometry::mesh_file: what the readers of the mesh formats share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <Eigen/Core>

#include "core/error.h"
#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint::mesh_file {

/// Collects vertices and polygons and checks them as they come.
class Soup {
 public:
  /// @param place  where a fault is reported: the cursor's place, or only the file for binaries
  void add_vertex(const Eigen::Vector3d& vertex, const Place& place);
  /// Corners count from 0 and may come before their vertices.
  void add_polygon(std::span<const std::int64_t> corners, const Place& place);

  std::int64_t num_vertices() const { return static_cast<std::int64_t>(mesh_.vertices_mm.size()); }

  std::size_t num_triangles() const { return mesh_.triangles.size(); }

  void reserve(std::size_t vertices, std::size_t triangles);

  /// The mesh; reports an index beyond the last vertex at the place where it stood.
  TriangleMesh take();

 private:
  TriangleMesh mesh_;
  std::int64_t num_polygons_ = 0;
  std::int64_t largest_corner_ = -1;
  std::int64_t largest_corner_face_ = 0;
  Place largest_corner_place_;
};

/// Refuses a count that the bytes left in the file cannot hold, before memory is asked for.
void check_count(std::int64_t count,
                 std::size_t bytes_each,
                 std::size_t bytes_left,
                 std::string_view what,
                 const Place& place);

}  // namespace glint::mesh_file

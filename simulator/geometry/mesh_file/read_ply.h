// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::geometry::mesh_file: the reader of PLY files.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint::mesh_file {

TriangleMesh read_ply(std::string_view bytes, const std::string& file);
/// The same, with the colour of each triangle's face.
TriangleMesh read_ply(std::string_view bytes,
                      const std::string& file,
                      std::vector<std::array<std::uint8_t, 3>>& colours);
/// The same, with a property of each triangle's face.
TriangleMesh read_ply(std::string_view bytes,
                      const std::string& file,
                      std::string_view property,
                      std::vector<std::int32_t>& values);

}  // namespace glint::mesh_file

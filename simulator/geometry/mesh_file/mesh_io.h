// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangle meshes from files: STL (binary, ASCII), PLY (ASCII, binary of either byte order), OBJ,
// OFF, and ViSP's CAO models. Own readers, so that an error names its line and garbage cannot
// crash.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// Reads a mesh in the units of its file: vertices of equal coordinates welded, polygons cut into
/// fans, no normals, no patches. The format follows from the content, then from the extension.
/// @throws IoError    the file cannot be read
/// @throws ConfigError `file:line:column: what is wrong` (vertex or face number for binary files):
///         truncated, no number, index out of range, not finite, no triangle, unknown format
TriangleMesh read_mesh(const std::filesystem::path& path);

/// The same for bytes in memory; name stands for the file in messages and gives the extension.
TriangleMesh parse_mesh(std::string_view bytes, const std::string& name);

/// The colours red, green, blue of a PLY file's faces, one for each triangle that read_mesh() makes
/// of it; numbers in [0, 1] of float properties count as [0, 255].
/// @throws IoError, ConfigError as read_mesh(), and when it is no PLY or its faces have no colours
std::vector<std::array<std::uint8_t, 3>> read_face_colours(const std::filesystem::path& path);

/// Reads a PLY and a property of its faces, unlike read_mesh() without welding, so that vertices
/// and triangles are those of the file.
/// @param values  one a triangle; a polygon's value for all the triangles it is cut into
/// @throws as read_mesh(); ConfigError when the faces have no such property or it is no whole
///         number of 32 bits
TriangleMesh read_ply_with_values(const std::filesystem::path& path,
                                  std::string_view property,
                                  std::vector<std::int32_t>& values);

}  // namespace glint

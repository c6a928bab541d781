// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangle meshes from and to files: STL (binary, ASCII), PLY (ASCII, binary of either byte
// order), OBJ, OFF. Own readers, so that an error names its line and garbage cannot crash.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "simulator/geometry/triangle_mesh.h"

namespace glint {

/// Reads a mesh in the units of its file: vertices of equal coordinates welded, polygons cut into
/// fans, no normals, no patches. The format follows from the content, then from the extension.
/// @throws IoError    the file cannot be read
/// @throws ConfigError `file:line:column: what is wrong` (vertex or face number for binary files):
///         truncated, no number, index out of range, not finite, no triangle, unknown format
TriangleMesh read_mesh(const std::filesystem::path& path);

/// The same for bytes in memory; name stands for the file in messages and gives the extension.
TriangleMesh parse_mesh(std::string_view bytes, const std::string& name);

/// Writes vertices and triangles by extension: .stl (binary, float), .ply (binary, double), .obj,
/// .off (shortest text that reads back the same). The file appears by rename.
/// @throws ConfigError for another extension, IoError when it cannot be written.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace glint

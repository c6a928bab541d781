// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::geometry::mesh_file: the reader of STL files.
#pragma once

#include <string>
#include <string_view>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint::mesh_file {

/// True for a binary STL by its size, or for a text that begins like an ASCII STL.
bool looks_like_stl(std::string_view bytes);

TriangleMesh read_stl(std::string_view bytes, const std::string& file);

}  // namespace glint::mesh_file

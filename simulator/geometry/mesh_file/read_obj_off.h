// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::geometry::mesh_file: the readers of OBJ and OFF files.
#pragma once

#include <string>
#include <string_view>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint::mesh_file {

/// True when the first word is OFF or one of its variants (COFF, NOFF, STOFF, ...).
bool looks_like_off(std::string_view bytes);

TriangleMesh read_obj(std::string_view bytes, const std::string& file);
TriangleMesh read_off(std::string_view bytes, const std::string& file);

}  // namespace glint::mesh_file

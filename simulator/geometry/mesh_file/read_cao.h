// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::geometry::mesh_file: the reader of ViSP's CAO models.
#pragma once

#include <string>
#include <string_view>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint::mesh_file {

/// True when the first word is V1, the only version.
bool looks_like_cao(std::string_view bytes);

/// The faces that are given by points. Lines are read over; faces given by lines, cylinders and
/// circles are refused. CAO models are in metres by custom: read them with the unit "m".
/// Source: ViSP's tutorial "How to model your object with a CAO file".
TriangleMesh read_cao(std::string_view bytes, const std::string& file);

}  // namespace glint::mesh_file

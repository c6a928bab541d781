// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part that Glint and its peers render: z = -x^2 / 2000 - y^2 / 120 [mm] on 200 x 50 mm, less
// twelve Gaussian dents of sigma 0.28 mm and 10 um depth, as an open mesh of 1400 x 350 quads.
#pragma once

#include <filesystem>
#include <span>

#include "simulator/geometry/part/part.h"

namespace glint::peers {

/// The mesh without normals; coordinates are floats, so that every tool has the same ones.
TriangleMesh make_part_mesh();

/// Meshes as raw arrays for Blender, each: number of vertices and of triangles (int32), vertices
/// (float), triangles (int32).
void write_raw_meshes(const std::filesystem::path& path, std::span<const TriangleMesh> meshes);

/// The mesh with its shading normals as POV-Ray's mesh2, a perfect mirror.
/// The mesh is smooth: all corners at a vertex share a normal.
void write_povray_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace glint::peers

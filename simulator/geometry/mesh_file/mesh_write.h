// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangle meshes to files: STL (binary), PLY (binary), OBJ, OFF.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// Writes vertices and triangles by extension: .stl (binary, float), .ply (binary, double), .obj,
/// .off (shortest text that reads back the same). The file appears by rename.
/// @throws ConfigError for another extension, IoError when it cannot be written.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

/// A whole number for every face, as a further property of a PLY.
struct FaceValues {
  std::string_view name = {};
  std::span<const std::int32_t> values = {};  ///< one a face; empty: no such property
};

/// A number for every face.
struct FaceNumbers {
  std::string_view name;
  std::span<const float> values;  ///< one a face
};

/// Red, green and blue of a vertex, as a screen shows them.
using VertexColour = std::array<std::uint8_t, 3>;

/// The bytes of write_mesh() for .stl, and for .ply with properties more.
/// @param colours  one a vertex; empty: no such properties
/// @param numbers  further properties of faces
std::string stl_bytes(const TriangleMesh& mesh);
std::string ply_bytes(const TriangleMesh& mesh,
                      const FaceValues& values = {},
                      std::span<const VertexColour> colours = {},
                      std::span<const FaceNumbers> numbers = {});

/// Lines of an OBJ file: all vertices; one face.
void append_obj_vertices(std::string& text, const TriangleMesh& mesh);
void append_obj_face(std::string& text, const Triangle& triangle);

}  // namespace glint

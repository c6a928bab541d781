// SPDX-License-Identifier: GPL-3.0-or-later
//
// A part with its defects as files: the shape for other programs, the shape with a defect id on
// every face, and the defect map. All appear by rename.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// What is lost when coordinates become float: vertices that fall together, faces that lose their
/// area because of it.
struct FloatLoss {
  std::int64_t merged_vertices = 0;
  std::int64_t collapsed_faces = 0;

  bool none() const { return merged_vertices == 0 && collapsed_faces == 0; }

  /// A sentence for the user; empty when nothing is lost.
  std::string warning() const;
};

/// Counts without writing. A merged vertex is one whose coordinates differ from those of a vertex
/// before it in double, but not in float.
FloatLoss float_loss(const TriangleMesh& mesh);

/// Binary STL: float, no labels; returns what that loses. @throws IoError
FloatLoss write_stl(const std::filesystem::path& path, const TriangleMesh& mesh);

/// Binary PLY: coordinates in double, vertices shared as in the mesh, and an int "defect_id" for
/// every face (0: the part itself). @param labels  one a face @throws IoError
void write_labelled_ply(const std::filesystem::path& path,
                        const TriangleMesh& mesh,
                        std::span<const std::int32_t> labels);

/// The defect map: an OBJ with the faces of defects in white and the others in black, by two
/// materials in a file of the same name with the extension .mtl beside it. Faces keep their order.
/// @throws IoError
void write_defect_map(const std::filesystem::path& obj_path,
                      const TriangleMesh& mesh,
                      std::span<const std::int32_t> labels);

}  // namespace glint

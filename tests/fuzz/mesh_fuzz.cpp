// SPDX-License-Identifier: GPL-3.0-or-later
//
// libFuzzer target of the mesh readers. The first byte chooses the file's extension, or what is
// read beside a PLY file's mesh (colours of faces, a number for each face); the rest is the file.
// Whatever comes out of them must be a sound mesh or a ConfigError.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/error.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "simulator/geometry/mesh_file/read_ply.h"

namespace {

constexpr std::array<const char*, 4> kNames = {"a.stl", "a.ply", "a.obj", "a.off"};

void read_bytes(std::size_t kind, std::string_view bytes) {
  if (kind < kNames.size()) {
    const glint::TriangleMesh mesh = glint::parse_mesh(bytes, kNames[kind]);
    GLINT_CHECK(glint::find_fault(mesh).empty(), "a reader let a faulty mesh through");
  } else if (kind == kNames.size()) {
    std::vector<std::array<std::uint8_t, 3>> colours;
    const glint::TriangleMesh mesh = glint::mesh_file::read_ply(bytes, "a.ply", colours);
    GLINT_CHECK(colours.size() == mesh.num_triangles(), "a colour for each triangle");
  } else {
    std::vector<std::int32_t> values;
    const glint::TriangleMesh mesh =
        glint::mesh_file::read_ply(bytes, "a.ply", "defect_id", values);
    GLINT_CHECK(values.size() == mesh.num_triangles(), "a number for each triangle");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  try {
    read_bytes(data[0] % (kNames.size() + 2), bytes);
  } catch (const glint::ConfigError&) {
    return 0;
  }
  return 0;
}

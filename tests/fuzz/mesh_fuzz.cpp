// SPDX-License-Identifier: GPL-3.0-or-later
//
// libFuzzer target of the mesh readers. The first byte chooses the file's extension; the rest is
// the file. Whatever comes out of them must be a sound mesh or a ConfigError.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/error.h"
#include "simulator/geometry/mesh_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<const char*, 4> kNames = {"a.stl", "a.ply", "a.obj", "a.off"};
  if (size == 0) {
    return 0;
  }
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  try {
    const glint::TriangleMesh mesh = glint::parse_mesh(bytes, kNames[data[0] % kNames.size()]);
    GLINT_CHECK(glint::find_fault(mesh).empty(), "a reader let a faulty mesh through");
  } catch (const glint::ConfigError&) {
    return 0;
  }
  return 0;
}

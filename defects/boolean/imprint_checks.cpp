// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/boolean/imprint_checks.h"

#include <vector>

#include <fmt/format.h>

#include "defects/boolean/patch_crossings.h"
#include "defects/boolean/patch_edges.h"

namespace glint {
namespace {

std::vector<TestFace> test_faces(const TriangleMesh& mesh) {
  std::vector<TestFace> faces;
  faces.reserve(mesh.num_triangles());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    faces.emplace_back(mesh.triangles[i],
                       Corners{mesh.vertex(i, 0), mesh.vertex(i, 1), mesh.vertex(i, 2)});
  }
  return faces;
}

}  // namespace

std::string tool_fault(const TriangleMesh& tool) {
  if (std::string fault = find_fault(tool); !fault.empty()) {
    return fault;
  }
  const EdgeMatches edges = match_edges(tool.triangles);
  if (edges.open > 0) {
    return fmt::format("it is not closed: {} open edges", edges.open);
  }
  if (edges.repeated > 0) {
    return fmt::format("{} edges have more than two faces or faces turned differently",
                       edges.repeated);
  }
  const std::vector<TestFace> faces = test_faces(tool);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (is_degenerate(faces[i])) {
      return fmt::format("triangle {} has no area", i);
    }
  }
  if (enclosed_volume_mm3(tool) <= 0.0) {
    return "it is turned inside out";
  }
  if (count_crossings(faces, 1) > 0) {
    return "it crosses itself";
  }
  return {};
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/boolean/patch_ring.h"

#include <algorithm>

#include "core/disjoint_sets.h"

namespace glint {
namespace {

std::vector<std::int32_t> marked(const std::vector<std::uint8_t>& marks) {
  std::vector<std::int32_t> indices;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i] != 0) {
      indices.push_back(static_cast<std::int32_t>(i));
    }
  }
  return indices;
}

/// Per face of a surface its place in a list of some, -1 for the others.
std::vector<std::int32_t> places(const std::vector<std::int32_t>& faces, std::size_t num_faces) {
  std::vector<std::int32_t> place(num_faces, -1);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    place[static_cast<std::size_t>(faces[i])] = static_cast<std::int32_t>(i);
  }
  return place;
}

/// Joins corners that are the same vertex of the same fan of faces. A vertex in which the ring only
/// touches itself becomes several, so that the ring is a manifold.
DisjointSets join_fans(const std::vector<std::int32_t>& faces,
                       std::size_t num_faces,
                       const EdgeMatches& edges) {
  const std::vector<std::int32_t> place = places(faces, num_faces);
  DisjointSets fans(3 * faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t other = edges.opposite[static_cast<std::size_t>(3 * faces[i] + k)];
      if (other < 0 || place[static_cast<std::size_t>(other / 3)] < 0) {
        continue;
      }
      const std::int32_t here = 3 * static_cast<std::int32_t>(i) + k;
      const std::int32_t there = 3 * place[static_cast<std::size_t>(other / 3)] + other % 3;
      fans.join(here, next_corner(there));
      fans.join(next_corner(here), there);
    }
  }
  return fans;
}

Ring make_ring(std::vector<std::int32_t> faces,
               std::span<const TestFace> surface,
               const EdgeMatches& edges) {
  Ring ring;
  DisjointSets fans = join_fans(faces, surface.size(), edges);
  std::vector<std::int32_t> point_of_fan(3 * faces.size(), -1);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const TestFace& face = surface[static_cast<std::size_t>(faces[i])];
    Triangle triangle = {};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t fan = fans.find(static_cast<std::int32_t>(3 * i + k));
      std::int32_t& point = point_of_fan[static_cast<std::size_t>(fan)];
      if (point < 0) {
        point = static_cast<std::int32_t>(ring.vertex_ids.size());
        ring.vertex_ids.push_back(face.ids[k]);
        ring.mesh.points_mm.push_back(face.corners[k]);
      }
      triangle[k] = point;
    }
    ring.mesh.faces.push_back(triangle);
  }
  ring.faces = std::move(faces);
  return ring;
}

}  // namespace

Patch::Patch(const ImprintedMeshState& part, const PatchTool& tool) {
  part.visit_if([&](const FloatBox& box) { return tool.box.may_intersect(box); },
                [&](std::int32_t face) { faces.push_back(face); });
  std::sort(faces.begin(), faces.end());
  std::size_t num_kept = 0;
  tests.reserve(faces.size());
  triangles.reserve(faces.size());
  for (const std::int32_t face : faces) {
    const TestFace test = part.test_face(face);
    if (tool.box.may_intersect(test.corners)) {
      faces[num_kept++] = face;
      tests.push_back(test);
      triangles.push_back(test.ids);
    }
  }
  faces.resize(num_kept);
  edges = match_edges(triangles);
}

RingPair find_rings(const Patch& patch, const PatchTool& tool) {
  RingPair rings;
  std::vector<std::uint8_t> in_patch(patch.faces.size(), 0);
  std::vector<std::uint8_t> in_tool(tool.faces.size(), 0);
  for (std::size_t i = 0; i < patch.tests.size(); ++i) {
    tool.tree.visit(patch.tests[i].box(), [&](std::int32_t face) {
      const auto j = static_cast<std::size_t>(face);
      if (may_intersect(patch.tests[i], tool.faces[j])) {
        in_patch[i] = 1;
        in_tool[j] = 1;
        rings.pairs.emplace_back(static_cast<std::int32_t>(i), face);
      }
    });
  }
  rings.part = make_ring(marked(in_patch), patch.tests, patch.edges);
  rings.tool = make_ring(marked(in_tool), tool.faces, tool.edges);
  const std::vector<std::int32_t> place_in_part = places(rings.part.faces, patch.faces.size());
  const std::vector<std::int32_t> place_in_tool = places(rings.tool.faces, tool.faces.size());
  for (auto& [part_face, tool_face] : rings.pairs) {
    part_face = place_in_part[static_cast<std::size_t>(part_face)];
    tool_face = place_in_tool[static_cast<std::size_t>(tool_face)];
  }
  return rings;
}

bool is_broken(const Ring& ring, std::span<const TestFace> surface) {
  std::vector<TestFace> faces;
  faces.reserve(ring.faces.size());
  for (const std::int32_t face : ring.faces) {
    faces.push_back(surface[static_cast<std::size_t>(face)]);
    if (is_degenerate(faces.back())) {
      return true;
    }
  }
  return count_crossings(faces, 1) > 0;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Accepts or refuses the new surface of an imprint: its border must be the border of what was
// removed, all other edges must have two faces, no face may be without area, and no new face may
// cross another or one that stays nearby (exact predicates). Crossings that the part had before do
// not count against it. docs/theory/imprint.md, "Acceptance". Cost: one query in a tree of boxes
// (box_tree.h) per new face and neighbour.
#include "defects/boolean/patch_check.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/index.h"
#include "defects/boolean/box_tree.h"
#include "defects/boolean/patch_crossings.h"
#include "defects/boolean/patch_edges.h"

namespace glint {
namespace {

/// Edges of the removed faces towards faces that stay, or towards nothing.
std::vector<std::uint64_t> old_border(const NewSurface& surface, const Patch& patch) {
  std::vector<std::uint64_t> border;
  for (const std::int32_t face : surface.removed) {
    for (std::int32_t corner = 3 * face; corner < 3 * face + 3; ++corner) {
      const std::int32_t other = patch.edges.opposite[index(corner)];
      if (other < 0 || surface.is_removed[index(other / 3)] == 0) {
        border.push_back(edge_key(vertex_at(patch.triangles, corner),
                                  vertex_at(patch.triangles, next_corner(corner))));
      }
    }
  }
  std::sort(border.begin(), border.end());
  return border;
}

std::vector<Triangle> triangles_of(const NewSurface& surface) {
  std::vector<Triangle> triangles;
  triangles.reserve(surface.faces.size());
  for (const AddedFace& face : surface.faces) {
    triangles.push_back(face.vertices);
  }
  return triangles;
}

/// Edges between old vertices inside the new surface: they must not be edges of faces that stay.
struct InnerEdges {
  std::vector<std::uint64_t> keys;  ///< ascending
  std::vector<std::uint64_t> border;
  bool is_manifold = true;
};

InnerEdges edges_of(const NewSurface& surface, std::int32_t num_old_vertices) {
  const std::vector<Triangle> triangles = triangles_of(surface);
  const EdgeMatches matches = match_edges(triangles);
  InnerEdges edges;
  edges.is_manifold = matches.repeated == 0;
  for (std::size_t i = 0; i < matches.opposite.size(); ++i) {
    const auto corner = static_cast<std::int32_t>(i);
    const std::int32_t from = vertex_at(triangles, corner);
    const std::int32_t to = vertex_at(triangles, next_corner(corner));
    if (matches.opposite[i] < 0) {
      edges.border.push_back(edge_key(from, to));
    } else if (from < num_old_vertices && to < num_old_vertices) {
      edges.keys.push_back(edge_key(from, to));
    }
  }
  std::sort(edges.keys.begin(), edges.keys.end());
  std::sort(edges.border.begin(), edges.border.end());
  return edges;
}

/// Faces that stay near the pieces of part faces; all else near the new surface did not meet it.
std::vector<std::int32_t> staying_neighbours(const NewSurface& surface,
                                             const Patch& patch,
                                             const ImprintedMeshState& part) {
  std::vector<std::int32_t> neighbours;
  for (const std::int32_t parent : surface.split_parents) {
    const FloatBox query = patch.tests[index(parent)].box();
    part.visit_if([&](const FloatBox& box) { return box.overlaps(query); },
                  [&](std::int32_t face) { neighbours.push_back(face); });
  }
  std::sort(neighbours.begin(), neighbours.end());
  neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  std::vector<std::int32_t> staying;
  std::size_t next = 0;
  for (const std::int32_t face : neighbours) {
    while (next < surface.removed.size() && patch.faces[index(surface.removed[next])] < face) {
      ++next;
    }
    if (next == surface.removed.size() || patch.faces[index(surface.removed[next])] != face) {
      staying.push_back(face);
    }
  }
  return staying;
}

/// The cut faces of the new surface, to be tested against each other and against others.
class CutFaces {
 public:
  CutFaces(const NewSurface& surface, const Patch& patch) : surface_(surface), patch_(patch) {
    std::vector<FloatBox> boxes;
    for (std::size_t i = 0; i < surface.tests.size(); ++i) {
      if (surface.is_cut[i] != 0) {
        cut_.push_back(i);
        boxes.push_back(surface.tests[i].box());
      }
    }
    tree_ = BoxTree(boxes);
  }

  bool has_degenerate() const {
    return std::any_of(
        cut_.begin(), cut_.end(), [&](std::size_t i) { return is_degenerate(surface_.tests[i]); });
  }

  /// Each pair of cut faces, and each cut face with each whole one of the tool.
  bool cross_each_other() const {
    for (std::size_t i = 0; i < surface_.tests.size(); ++i) {
      const std::int32_t parent = surface_.parent[i];
      const TestFace* before = parent < 0 ? nullptr : &patch_.tests[index(parent)];
      const bool is_cut = surface_.is_cut[i] != 0;
      if (crosses(
              surface_.tests[i], before, [&](std::size_t j) { return is_cut ? j > i : j != i; })) {
        return true;
      }
    }
    return false;
  }

  /// A face that stays.
  bool cross(const TestFace& face) const {
    return crosses(face, &face, [](std::size_t) { return true; });
  }

 private:
  /// before: what the face was a piece of; a part that crosses itself may go on doing so.
  template <class Wanted>
  bool crosses(const TestFace& face, const TestFace* before, const Wanted& is_wanted) const {
    bool is_found = false;
    tree_.visit(face.box(), [&](std::int32_t number) {
      const std::size_t j = cut_[index(number)];
      is_found = is_found || (is_wanted(j) && faces_cross(face, surface_.tests[j]) &&
                              !crossed_already(before, surface_.parent[j]));
    });
    return is_found;
  }

  bool crossed_already(const TestFace* before, std::int32_t parent) const {
    if (before == nullptr || parent < 0) {
      return false;
    }
    const TestFace& other = patch_.tests[index(parent)];
    return before->ids != other.ids && faces_cross(*before, other);
  }

  const NewSurface& surface_;
  const Patch& patch_;
  std::vector<std::size_t> cut_;
  BoxTree tree_;
};

bool shares_edge(const Triangle& face, const std::vector<std::uint64_t>& keys) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::binary_search(keys.begin(), keys.end(), edge_key(face[k], face[(k + 1) % 3]))) {
      return true;
    }
  }
  return false;
}

}  // namespace

ImprintOutcome check_surface(const NewSurface& surface,
                             const Patch& patch,
                             const ImprintedMeshState& part) {
  const InnerEdges edges = edges_of(surface, part.num_vertices());
  if (!edges.is_manifold || edges.border != old_border(surface, patch)) {
    return ImprintOutcome::kOpenSeam;
  }
  const CutFaces cut(surface, patch);
  if (cut.has_degenerate()) {
    return ImprintOutcome::kDegenerate;
  }
  if (cut.cross_each_other()) {
    return ImprintOutcome::kSelfIntersection;
  }
  for (const std::int32_t face : staying_neighbours(surface, patch, part)) {
    const TestFace test = part.test_face(face);
    if (shares_edge(test.ids, edges.keys) || cut.cross(test)) {
      return ImprintOutcome::kSelfIntersection;
    }
  }
  return ImprintOutcome::kDone;
}

}  // namespace glint

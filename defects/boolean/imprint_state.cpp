// SPDX-License-Identifier: GPL-3.0-or-later
//
// A part with imprints as the part at first, shared by all copies, and what each imprint took and
// added: a block of faces with a box tree of its own. So an imprint costs what it touches, not what
// the part holds, and a refused one is undone by dropping a copy; a search looks into the tree of
// every block. Only result() goes over all faces and renumbers them. docs/theory/imprint.md,
// "Boolean operation".
#include "defects/boolean/imprint_state.h"

#include <algorithm>
#include <unordered_map>

#include "core/error.h"
#include "core/index.h"
#include "defects/boolean/patch_probe.h"

namespace glint {
namespace {

using Eigen::Vector3d;

bool is_collapsed(const Triangle& triangle) {
  return triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
}

/// Without shading normals; patches only where there are some.
TriangleMesh geometry_of(const TriangleMesh& part) {
  if (const std::string fault = find_fault(part); !fault.empty()) {
    throw ConfigError("the part cannot be imprinted: " + fault);
  }
  TriangleMesh mesh;
  mesh.vertices_mm = part.vertices_mm;
  mesh.triangles = part.triangles;
  mesh.patch = part.patch;
  return mesh;
}

/// Collapsed triangles get an empty box, so that no search finds them.
BoxTree tree_over(const TriangleMesh& mesh) {
  std::vector<FloatBox> boxes(mesh.num_triangles());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!is_collapsed(mesh.triangles[i])) {
      boxes[i] = box_of(mesh.vertex(i, 0), mesh.vertex(i, 1), mesh.vertex(i, 2));
    }
  }
  return BoxTree(boxes);
}

}  // namespace

ImprintedBase::ImprintedBase(const TriangleMesh& part)
    : mesh(geometry_of(part)), tree(tree_over(mesh)) {}

ImprintedMeshState::ImprintedMeshState(const TriangleMesh& part)
    : base_(std::make_shared<const ImprintedBase>(part)),
      is_removed_(part.num_triangles(), false),
      num_alive_(part.num_triangles()) {}

std::int32_t ImprintedMeshState::num_vertices() const {
  return static_cast<std::int32_t>(base_->mesh.vertices_mm.size() + added_vertices_mm_.size());
}

const Vector3d& ImprintedMeshState::vertex(std::int32_t number) const {
  const std::size_t num_base = base_->mesh.vertices_mm.size();
  return index(number) < num_base ? base_->mesh.vertices_mm[index(number)]
                                  : added_vertices_mm_[index(number) - num_base];
}

const Triangle& ImprintedMeshState::triangle(std::int32_t face) const {
  return face < num_base_faces() ? base_->mesh.triangles[index(face)]
                                 : added_faces_[index(face - num_base_faces())].vertices;
}

std::int32_t ImprintedMeshState::label(std::int32_t face) const {
  return face < num_base_faces() ? 0 : added_faces_[index(face - num_base_faces())].label;
}

std::int32_t ImprintedMeshState::origin(std::int32_t face) const {
  return face < num_base_faces() ? face : added_faces_[index(face - num_base_faces())].origin;
}

std::int32_t ImprintedMeshState::patch(std::int32_t face) const {
  const std::int32_t from = origin(face);
  return from < 0 ? -1 : base_->mesh.patch_of(index(from));
}

TestFace ImprintedMeshState::test_face(std::int32_t face) const {
  const Triangle& corners = triangle(face);
  return {corners, {vertex(corners[0]), vertex(corners[1]), vertex(corners[2])}};
}

bool ImprintedMeshState::contains(const Vector3d& point) const {
  return is_inside_surface(point, [&](const Probe& probe) {
    int hits = 0;
    visit_if([&](const FloatBox& box) { return probe.may_intersect(box); },
             [&](std::int32_t face) { hits += probe.hits(test_face(face).corners) ? 1 : 0; });
    return hits;
  });
}

void ImprintedMeshState::apply(const PatchChange& change) {
  for (const std::int32_t face : change.removed) {
    is_removed_[index(face)] = true;
  }
  const auto first_face = static_cast<std::int32_t>(is_removed_.size());
  blocks_.push_back({first_face, std::make_shared<const BoxTree>(change.boxes)});
  added_vertices_mm_.insert(
      added_vertices_mm_.end(), change.vertices_mm.begin(), change.vertices_mm.end());
  added_faces_.insert(added_faces_.end(), change.faces.begin(), change.faces.end());
  is_removed_.resize(is_removed_.size() + change.faces.size(), false);
  num_alive_ += change.faces.size();
  num_alive_ -= change.removed.size();
}

MeshCutout ImprintedMeshState::cutout(const BoundingBox& box_mm) const {
  MeshCutout out;
  const FloatBox query = box_of(box_mm.min_mm, box_mm.min_mm, box_mm.max_mm);
  visit_if([&](const FloatBox& box) { return box.overlaps(query); },
           [&](std::int32_t face) { out.faces.push_back(face); });
  std::ranges::sort(out.faces);
  std::unordered_map<std::int32_t, std::int32_t> numbers;
  for (const std::int32_t face : out.faces) {
    Triangle& corners = out.mesh.triangles.emplace_back(triangle(face));
    for (std::int32_t& corner : corners) {
      const auto [place_of_corner, is_new] =
          numbers.try_emplace(corner, static_cast<std::int32_t>(out.vertices.size()));
      if (is_new) {
        out.vertices.push_back(corner);
        out.mesh.vertices_mm.push_back(vertex(corner));
      }
      corner = place_of_corner->second;
    }
    out.labels.push_back(label(face));
    out.origin.push_back(origin(face));
    out.mesh.patch.push_back(patch(face));
  }
  return out;
}

PatchChange ImprintedMeshState::change_to(const MeshCutout& finer) const {
  PatchChange change;
  const std::size_t num_old = finer.vertices.size();
  const auto number_of = [&](std::int32_t vertex) {
    return index(vertex) < num_old ? finer.vertices[index(vertex)]
                                   : num_vertices() + vertex - static_cast<std::int32_t>(num_old);
  };
  const auto& points = finer.mesh.vertices_mm;
  change.vertices_mm.assign(points.begin() + static_cast<std::ptrdiff_t>(num_old), points.end());
  for (std::size_t i = 0; i < finer.mesh.num_triangles(); ++i) {
    const Triangle& t = finer.mesh.triangles[i];
    const Triangle corners = {number_of(t[0]), number_of(t[1]), number_of(t[2])};
    if (i < finer.faces.size()) {
      if (corners == triangle(finer.faces[i])) {
        continue;
      }
      change.removed.push_back(finer.faces[i]);
    }
    change.faces.push_back(
        {.vertices = corners, .label = finer.labels[i], .origin = finer.origin[i]});
    change.boxes.push_back(
        box_of(finer.mesh.vertex(i, 0), finer.mesh.vertex(i, 1), finer.mesh.vertex(i, 2)));
  }
  return change;
}

/// Copies the vertices that are used; returns the new index of each.
std::vector<std::int32_t> ImprintedMeshState::renumbered_vertices(TriangleMesh& out) const {
  std::vector<std::int32_t> renumbered(index(num_vertices()), -1);
  for (std::size_t face = 0; face < is_removed_.size(); ++face) {
    if (!is_removed_[face]) {
      for (const std::int32_t corner : triangle(static_cast<std::int32_t>(face))) {
        renumbered[index(corner)] = 0;
      }
    }
  }
  out.vertices_mm.reserve(renumbered.size());
  for (std::size_t i = 0; i < renumbered.size(); ++i) {
    if (renumbered[i] == 0) {
      renumbered[i] = static_cast<std::int32_t>(out.vertices_mm.size());
      out.vertices_mm.push_back(vertex(static_cast<std::int32_t>(i)));
    }
  }
  return renumbered;
}

ImprintedMesh::Labelled ImprintedMeshState::result() const {
  ImprintedMesh::Labelled out;
  const std::vector<std::int32_t> renumbered = renumbered_vertices(out.mesh);
  const bool has_patches = !base_->mesh.patch.empty();
  out.mesh.triangles.reserve(num_alive_);
  out.labels.reserve(num_alive_);
  out.origin.reserve(num_alive_);
  out.mesh.patch.reserve(has_patches ? num_alive_ : 0);
  for (std::size_t i = 0; i < is_removed_.size(); ++i) {
    if (is_removed_[i]) {
      continue;
    }
    const auto face = static_cast<std::int32_t>(i);
    const Triangle& from = triangle(face);
    out.mesh.triangles.push_back(
        {renumbered[index(from[0])], renumbered[index(from[1])], renumbered[index(from[2])]});
    out.labels.push_back(label(face));
    out.origin.push_back(origin(face));
    if (has_patches) {
      out.mesh.patch.push_back(patch(face));
    }
  }
  return out;
}

std::size_t ImprintedMeshState::memory_bytes() const {
  const TriangleMesh& mesh = base_->mesh;
  std::size_t bytes = mesh.vertices_mm.capacity() * sizeof(Vector3d) +
                      mesh.triangles.capacity() * sizeof(Triangle) +
                      mesh.patch.capacity() * sizeof(std::int32_t) + base_->tree.memory_bytes() +
                      is_removed_.capacity() / 8 +
                      added_vertices_mm_.capacity() * sizeof(Vector3d) +
                      added_faces_.capacity() * sizeof(AddedFace);
  for (const Block& block : blocks_) {
    bytes += block.tree->memory_bytes();
  }
  return bytes;
}

}  // namespace glint

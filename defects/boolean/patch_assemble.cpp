// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is kept after the cut: of the part the pieces outside the tool, of the tool the pieces
// inside the part (turned over, where it is cut out) or outside it (where it is added). Faces that
// no cut has split stay what they are, so that an imprint changes its ring alone; points on the
// seam are taken from the part once, so that the surfaces join without a gap. The volume follows
// from the divergence theorem, as both surfaces have the same border. Cost: linear in the faces of
// ring and tool. docs/theory/imprint.md, "Boolean operation".
#include "defects/boolean/patch_assemble.h"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>

#include "core/index.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Six times the volume between a triangle and a point.
double volume6(const Corners& c, const Vector3d& origin) {
  return (c[0] - origin).dot((c[1] - origin).cross(c[2] - origin));
}

class Assembler {
 public:
  Assembler(const CutSurfaces& surfaces,
            const ImprintedMeshState& part,
            std::int32_t label,
            ImprintOperation operation)
      : s_(surfaces),
        part_(part),
        label_(label),
        is_cutting_(operation == ImprintOperation::kSubtract),
        part_points_(surfaces.cut.first.points_mm.size(), -1),
        tool_points_(surfaces.tool.vertices_mm.size(), -1) {}

  NewSurface run() {
    out_.is_removed.assign(s_.patch.faces.size(), 0);
    mark_removed();
    add_part_pieces();
    add_tool_pieces();
    for (std::size_t i = 0; i < out_.is_removed.size(); ++i) {
      if (out_.is_removed[i] != 0) {
        out_.removed.push_back(static_cast<std::int32_t>(i));
      }
    }
    out_.removed_volume_mm3 = removed_volume();
    return std::move(out_);
  }

 private:
  /// Faces inside the tool, and faces that were split.
  void mark_removed() {
    const CorefinedMesh& cut = s_.cut.first;
    std::vector<std::int32_t> num_pieces(s_.rings.part.faces.size(), 0);
    for (const std::int32_t parent : cut.parent) {
      ++num_pieces[index(parent)];
    }
    is_split_.resize(num_pieces.size());
    std::transform(num_pieces.begin(), num_pieces.end(), is_split_.begin(), [](std::int32_t n) {
      return static_cast<std::uint8_t>(n > 1 ? 1 : 0);
    });
    for (std::size_t i = 0; i < cut.faces.size(); ++i) {
      const std::int32_t parent = cut.parent[i];
      const bool is_inside = s_.part_pieces.is_inside(static_cast<std::int32_t>(i));
      out_.num_swallowed += is_inside ? 1 : 0;
      if (is_inside || is_split_[index(parent)] != 0) {
        out_.is_removed[index(s_.rings.part.faces[index(parent)])] = 1;
      }
    }
    for (std::size_t i = 0; i < out_.is_removed.size(); ++i) {
      const auto face = static_cast<std::int32_t>(i);
      if (!s_.part_pieces.is_in_ring(face) &&
          s_.part_pieces.is_inside(s_.part_pieces.member_of_face(face))) {
        out_.is_removed[i] = 1;
        ++out_.num_swallowed;
      }
    }
  }

  void add_part_pieces() {
    const CorefinedMesh& cut = s_.cut.first;
    std::int32_t last_parent = -1;
    for (std::size_t i = 0; i < cut.faces.size(); ++i) {
      const std::int32_t parent = cut.parent[i];
      if (is_split_[index(parent)] == 0 || s_.part_pieces.is_inside(static_cast<std::int32_t>(i))) {
        continue;
      }
      Triangle ids = {};
      std::transform(cut.faces[i].begin(), cut.faces[i].end(), ids.begin(), [&](std::int32_t v) {
        return part_vertex(v);
      });
      const std::int32_t in_patch = s_.rings.part.faces[index(parent)];
      const std::int32_t face = s_.patch.faces[index(in_patch)];
      add_face({ids, part_.label(face), part_.origin(face)}, true, in_patch);
      if (parent != last_parent) {
        out_.split_parents.push_back(in_patch);
        last_parent = parent;
      }
    }
    std::sort(out_.split_parents.begin(), out_.split_parents.end());
    out_.split_parents.erase(std::unique(out_.split_parents.begin(), out_.split_parents.end()),
                             out_.split_parents.end());
  }

  void add_tool_pieces() {
    const CorefinedMesh& cut = s_.cut.second;
    std::vector<std::int32_t> num_pieces(s_.rings.tool.faces.size(), 0);
    for (const std::int32_t parent : cut.parent) {
      ++num_pieces[index(parent)];
    }
    for (std::size_t i = 0; i < cut.faces.size(); ++i) {
      if (s_.tool_pieces.is_inside(static_cast<std::int32_t>(i)) != is_cutting_) {
        continue;
      }
      Triangle ids = {};
      std::transform(cut.faces[i].begin(), cut.faces[i].end(), ids.begin(), [&](std::int32_t v) {
        return tool_vertex(v);
      });
      add_tool_face(ids, num_pieces[index(cut.parent[i])] > 1);
    }
    for (std::size_t i = 0; i < s_.tool.triangles.size(); ++i) {
      const auto face = static_cast<std::int32_t>(i);
      if (s_.tool_pieces.is_in_ring(face) ||
          s_.tool_pieces.is_inside(s_.tool_pieces.member_of_face(face)) != is_cutting_) {
        continue;
      }
      Triangle ids = {};
      std::transform(s_.tool.triangles[i].begin(),
                     s_.tool.triangles[i].end(),
                     ids.begin(),
                     [&](std::int32_t v) { return whole_tool_vertex(v); });
      add_tool_face(ids, false);
    }
  }

  void add_tool_face(Triangle ids, bool is_cut) {
    if (is_cutting_) {
      std::swap(ids[1], ids[2]);
    }
    add_face({ids, label_, -1}, is_cut, -1);
    ++out_.num_tool_faces;
  }

  void add_face(const AddedFace& face, bool is_cut, std::int32_t parent) {
    const Triangle& v = face.vertices;
    out_.faces.push_back(face);
    out_.is_cut.push_back(is_cut ? 1 : 0);
    out_.parent.push_back(parent);
    out_.tests.emplace_back(v, Corners{point(v[0]), point(v[1]), point(v[2])});
  }

  const Vector3d& point(std::int32_t vertex) const {
    const std::int32_t num_old = part_.num_vertices();
    return vertex < num_old ? part_.vertex(vertex) : out_.vertices_mm[index(vertex - num_old)];
  }

  std::int32_t add_vertex(const Vector3d& point_mm) {
    out_.vertices_mm.push_back(point_mm);
    return part_.num_vertices() + static_cast<std::int32_t>(out_.vertices_mm.size()) - 1;
  }

  std::int32_t part_vertex(std::int32_t cut_vertex) {
    const std::vector<std::int32_t>& old = s_.rings.part.vertex_ids;
    if (index(cut_vertex) < old.size()) {
      return old[index(cut_vertex)];
    }
    std::int32_t& vertex = part_points_[index(cut_vertex)];
    if (vertex < 0) {
      vertex = add_vertex(s_.cut.first.points_mm[index(cut_vertex)]);
    }
    return vertex;
  }

  std::int32_t tool_vertex(std::int32_t cut_vertex) {
    const std::int32_t on_seam = s_.seam.part_vertex[index(cut_vertex)];
    if (on_seam >= 0) {
      return part_vertex(on_seam);
    }
    const std::vector<std::int32_t>& old = s_.rings.tool.vertex_ids;
    return index(cut_vertex) < old.size() ? whole_tool_vertex(old[index(cut_vertex)])
                                          : add_vertex(s_.cut.second.points_mm[index(cut_vertex)]);
  }

  std::int32_t whole_tool_vertex(std::int32_t tool_vertex) {
    std::int32_t& vertex = tool_points_[index(tool_vertex)];
    if (vertex < 0) {
      vertex = add_vertex(s_.tool.vertices_mm[index(tool_vertex)]);
    }
    return vertex;
  }

  /// By the divergence theorem: both surfaces have the same border.
  double removed_volume() const {
    const Vector3d origin = s_.tool.vertices_mm[0];
    double sum = 0.0;
    for (const std::int32_t face : out_.removed) {
      sum += volume6(s_.patch.tests[index(face)].corners, origin);
    }
    for (const TestFace& face : out_.tests) {
      sum -= volume6(face.corners, origin);
    }
    return sum / 6.0;
  }

  const CutSurfaces& s_;
  const ImprintedMeshState& part_;
  std::int32_t label_ = 0;
  bool is_cutting_ = true;
  std::vector<std::int32_t> part_points_;  ///< per vertex of the cut part
  std::vector<std::int32_t> tool_points_;  ///< per vertex of the tool
  std::vector<std::uint8_t> is_split_;     ///< per face of the part's ring
  NewSurface out_;
};

}  // namespace

NewSurface assemble(const CutSurfaces& surfaces,
                    const ImprintedMeshState& part,
                    std::int32_t label,
                    ImprintOperation operation) {
  return Assembler(surfaces, part, label, operation).run();
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Corefinement in general position: each face that the seam crosses is cut along it. The face's
// border and the pieces of the seam inside it form a planar graph of corners and crossings, in
// which every crossing has one or two neighbours; walking around it gives the regions at the
// border, and closed seams inside become holes and regions of their own. Each region is projected
// along the largest component of the face's normal and triangulated (corefine_polygon.h). Own
// method: docs/theory/imprint.md, "Cutting". Cost: linear in the faces, quadratic in the corners of
// one cut face.
#include "defects/boolean/corefine_general.h"

#include <algorithm>
#include <array>
#include <span>

#include "core/index.h"
#include "defects/boolean/corefine_crossings.h"
#include "defects/boolean/corefine_polygon.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Splits the faces of one side along the seam.
class Splitter {
 public:
  Splitter(const CutSide& side, const std::vector<Vector3d>& nodes_mm)
      : side_(side),
        nodes_mm_(nodes_mm),
        first_node_(static_cast<std::int32_t>(side.surface.mesh.points_mm.size())),
        local_of_node_(nodes_mm.size(), -1) {}

  bool run(CorefinedMesh& out) {
    out.points_mm = side_.surface.mesh.points_mm;
    out.points_mm.insert(out.points_mm.end(), nodes_mm_.begin(), nodes_mm_.end());
    auto segment = side_.segments.begin();
    for (std::size_t face = 0; face < side_.surface.mesh.faces.size(); ++face) {
      auto last = segment;
      while (last != side_.segments.end() && last->face == static_cast<std::int32_t>(face)) {
        ++last;
      }
      if (segment == last) {
        out.faces.push_back(side_.surface.mesh.faces[face]);
      } else if (!split(static_cast<std::int32_t>(face), {segment, last}, out)) {
        return false;
      }
      out.parent.resize(out.faces.size(), static_cast<std::int32_t>(face));
      segment = last;
    }
    out.opposite = match_edges(out.faces).opposite;
    mark_seam(out);
    return true;
  }

 private:
  /// A corner of the face or a node in it.
  struct Local {
    std::int32_t vertex = 0;  ///< of the cut mesh
    std::array<std::int32_t, 2> links = {-1, -1};
    std::int32_t num_links = 0;
  };

  bool split(std::int32_t face, std::span<const FaceSegment> segments, CorefinedMesh& out) {
    locals_.clear();
    for (std::int32_t corner = 3 * face; corner < 3 * face + 3; ++corner) {
      add_border(corner);
    }
    num_border_ = static_cast<std::int32_t>(locals_.size());
    const bool is_linked = link(segments);
    for (const FaceSegment& segment : segments) {
      local_of_node_[index(segment.from)] = -1;
      local_of_node_[index(segment.to)] = -1;
    }
    for (const Local& local : locals_) {
      if (local.vertex >= first_node_) {
        local_of_node_[index(local.vertex - first_node_)] = -1;
      }
    }
    if (!is_linked) {
      return false;
    }
    project(face);
    return trace_regions() && trace_loops() && fill(out);
  }

  std::int32_t add_local(std::int32_t vertex) {
    locals_.push_back({.vertex = vertex});
    return static_cast<std::int32_t>(locals_.size()) - 1;
  }

  std::int32_t local_of(std::int32_t node) {
    std::int32_t& local = local_of_node_[index(node)];
    if (local < 0) {
      local = add_local(first_node_ + node);
    }
    return local;
  }

  /// A corner, then the nodes on the edge that starts there.
  void add_border(std::int32_t corner) {
    add_local(vertex_at(side_.surface.mesh.faces, corner));
    const std::int32_t edge = side_.edge_of(corner);
    const auto [first, last] =
        std::equal_range(side_.nodes.begin(),
                         side_.nodes.end(),
                         EdgeNode{.edge = edge},
                         [](const EdgeNode& a, const EdgeNode& b) { return a.edge < b.edge; });
    const auto count = last - first;
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      local_of((first + (edge == corner ? i : count - 1 - i))->node);
    }
  }

  bool link(std::span<const FaceSegment> segments) {
    for (const FaceSegment& segment : segments) {
      const std::int32_t from = local_of(segment.from);
      const std::int32_t to = local_of(segment.to);
      if (!add_link(from, to) || !add_link(to, from)) {
        return false;
      }
    }
    // A seam comes in over an edge and leaves over one, or is closed.
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(locals_.size()); ++i) {
      const Local& local = locals_[index(i)];
      const bool is_corner = local.vertex < first_node_;
      const std::int32_t wanted = is_corner ? 0 : i < num_border_ ? 1 : 2;
      if (local.num_links != wanted) {
        return false;
      }
    }
    return true;
  }

  bool add_link(std::int32_t from, std::int32_t to) {
    Local& local = locals_[index(from)];
    if (local.num_links == 2) {
      return false;
    }
    local.links[index(local.num_links++)] = to;
    return true;
  }

  /// Drops the axis along which the face's normal is longest, keeping the sense of rotation.
  void project(std::int32_t face) {
    int axis = 0;
    const Vector3d& normal = side_.surface.tests[index(face)].normal;
    normal.cwiseAbs().maxCoeff(&axis);
    const int u = normal[axis] > 0.0 ? (axis + 1) % 3 : (axis + 2) % 3;
    const int v = 3 - axis - u;
    flat_.clear();
    for (const Local& local : locals_) {
      const Vector3d& point = local.vertex < first_node_
                                  ? side_.surface.mesh.points_mm[index(local.vertex)]
                                  : nodes_mm_[index(local.vertex - first_node_)];
      flat_.emplace_back(point[u], point[v]);
    }
  }

  std::int32_t next_on_chain(std::int32_t from, std::int32_t at) const {
    const Local& local = locals_[index(at)];
    return local.links[0] == from ? local.links[1] : local.links[0];
  }

  /// Regions at the face's border: along the border, and along every seam that leaves it.
  bool trace_regions() {
    outers_.clear();
    is_used_.assign(locals_.size(), 0);
    for (std::int32_t start = 0; start < num_border_; ++start) {
      if (is_used_[index(start)] != 0) {
        continue;
      }
      Polygon polygon;
      std::int32_t at = start;
      do {
        if (is_used_[index(at)] != 0) {
          return false;
        }
        is_used_[index(at)] = 1;  // the piece of border that starts here
        polygon.push_back(at);
        at = (at + 1) % num_border_;
        if (locals_[index(at)].num_links == 1) {
          at = follow_chain(at, polygon);
        }
      } while (at != start);
      outers_.push_back(std::move(polygon));
    }
    return true;
  }

  /// Adds a seam's nodes but the last one, which lies on the border again.
  std::int32_t follow_chain(std::int32_t start, Polygon& polygon) {
    std::int32_t from = start;
    std::int32_t at = locals_[index(start)].links[0];
    polygon.push_back(start);
    while (at >= num_border_) {
      is_used_[index(at)] = 1;
      polygon.push_back(at);
      from = std::exchange(at, next_on_chain(from, at));
    }
    return at;
  }

  std::vector<Polygon> closed_seams() {
    std::vector<Polygon> loops;
    for (std::int32_t start = num_border_; start < static_cast<std::int32_t>(locals_.size());
         ++start) {
      if (is_used_[index(start)] == 0) {
        loops.push_back(trace_loop(start));
      }
    }
    return loops;
  }

  /// Closed seams inside the face: holes of one region and regions themselves. False when they lie
  /// in each other.
  bool trace_loops() {
    holes_.assign(outers_.size(), {});
    std::vector<Polygon> loops = closed_seams();
    for (std::size_t i = 0; i < loops.size(); ++i) {
      const Vector2d& point = flat_[index(loops[i][0])];
      for (std::size_t j = 0; j < loops.size(); ++j) {
        if (i != j && is_inside(flat_, loops[j], point)) {
          return false;
        }
      }
      const auto outer =
          std::find_if(outers_.begin(),
                       outers_.begin() + static_cast<std::ptrdiff_t>(holes_.size()),
                       [&](const Polygon& polygon) { return is_inside(flat_, polygon, point); });
      const auto which = static_cast<std::size_t>(outer - outers_.begin());
      if (which == holes_.size()) {
        return false;
      }
      holes_[which].emplace_back(loops[i].rbegin(), loops[i].rend());
    }
    for (Polygon& loop : loops) {
      outers_.push_back(std::move(loop));
    }
    holes_.resize(outers_.size());
    return true;
  }

  /// Counter-clockwise.
  Polygon trace_loop(std::int32_t start) {
    Polygon loop;
    std::int32_t from = locals_[index(start)].links[1];
    std::int32_t at = start;
    do {
      is_used_[index(at)] = 1;
      loop.push_back(at);
      from = std::exchange(at, next_on_chain(from, at));
    } while (at != start);
    if (doubled_area(flat_, loop) < 0.0) {
      std::reverse(loop.begin(), loop.end());
    }
    return loop;
  }

  bool fill(CorefinedMesh& out) {
    for (std::size_t i = 0; i < outers_.size(); ++i) {
      triangles_.clear();
      if (outers_[i].size() < 3 || !triangulate(flat_, outers_[i], holes_[i], triangles_)) {
        return false;
      }
      for (const Triangle& t : triangles_) {
        out.faces.push_back({locals_[index(t[0])].vertex,
                             locals_[index(t[1])].vertex,
                             locals_[index(t[2])].vertex});
      }
    }
    return true;
  }

  void mark_seam(CorefinedMesh& out) const {
    KeyTable seam(2 * side_.segments.size() + 1);
    for (const FaceSegment& segment : side_.segments) {
      seam.at(edge_key(segment.from, segment.to), 1);
      seam.at(edge_key(segment.to, segment.from), 1);
    }
    out.is_seam.assign(3 * out.faces.size(), 0);
    for (std::size_t i = 0; i < out.is_seam.size(); ++i) {
      const auto corner = static_cast<std::int32_t>(i);
      const std::int32_t from = vertex_at(out.faces, corner) - first_node_;
      const std::int32_t to = vertex_at(out.faces, next_corner(corner)) - first_node_;
      out.is_seam[i] = from >= 0 && to >= 0 && seam.find(edge_key(from, to), 0) == 1 ? 1 : 0;
    }
  }

  const CutSide& side_;
  const std::vector<Vector3d>& nodes_mm_;
  std::int32_t first_node_ = 0;
  std::vector<std::int32_t> local_of_node_;
  std::vector<Local> locals_;  ///< of the face at hand: its border in order, then the rest
  std::int32_t num_border_ = 0;
  std::vector<Vector2d> flat_;
  std::vector<std::uint8_t> is_used_;
  std::vector<Polygon> outers_;
  std::vector<std::vector<Polygon>> holes_;  ///< per outer polygon
  std::vector<Triangle> triangles_;
};

}  // namespace

std::optional<CorefinedPair> corefine_general(
    const GeneralSurface& first,
    const GeneralSurface& second,
    const std::vector<std::pair<std::int32_t, std::int32_t>>& pairs) {
  const std::optional<SurfaceCrossings> crossings = find_crossings(first, second, pairs);
  CorefinedPair out;
  out.is_done = true;
  if (!crossings || !Splitter(crossings->first, crossings->points_mm).run(out.first) ||
      !Splitter(crossings->second, crossings->points_mm).run(out.second)) {
    return std::nullopt;
  }
  return out;
}

}  // namespace glint

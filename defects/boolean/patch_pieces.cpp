// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pieces of the cut surfaces lie inside the other body. Faces are joined into pieces across
// all edges but those of the seam (union-find). At each edge of the seam the four faces around it
// are ordered by angle: that votes for the piece of each, weighted by the length of the edge and by
// how clear the angle is, so that a few badly rounded edges decide nothing. Pieces without a seam
// are decided by a ray (patch_probe.h). Own method: docs/theory/imprint.md, "Sorting". Cost: linear
// in the faces near the tool.
#include "defects/boolean/patch_pieces.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <Eigen/Geometry>

#include "core/index.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// A vertex of the seam in one of the two cut meshes.
struct SeamPoint {
  Vector3d point_mm;
  int mesh = 0;
  std::int32_t vertex = 0;
};

bool is_before(const SeamPoint& a, const SeamPoint& b) {
  const auto key = [](const SeamPoint& p) {
    return std::make_tuple(p.point_mm.x(), p.point_mm.y(), p.point_mm.z(), p.mesh, p.vertex);
  };
  return key(a) < key(b);
}

void add_seam_points(const CorefinedMesh& mesh, int which, std::vector<SeamPoint>& points) {
  std::vector<std::uint8_t> is_seen(mesh.points_mm.size(), 0);
  for (std::size_t corner = 0; corner < mesh.is_seam.size(); ++corner) {
    if (mesh.is_seam[corner] == 0) {
      continue;
    }
    const auto start = static_cast<std::int32_t>(corner);
    for (const std::int32_t end : {start, next_corner(start)}) {
      const std::int32_t vertex = vertex_at(mesh.faces, end);
      if (is_seen[index(vertex)] == 0) {
        is_seen[index(vertex)] = 1;
        points.push_back({mesh.points_mm[index(vertex)], which, vertex});
      }
    }
  }
}

/// Per vertex of both meshes a number that equal points of the seam share; -1 beside it.
struct SharedPoints {
  std::array<std::vector<std::int32_t>, 2> number;
  std::vector<std::int32_t> part_vertex;  ///< per number; -1: the part has no such point
};

SharedPoints number_points(const CorefinedPair& cut) {
  std::vector<SeamPoint> points;
  add_seam_points(cut.first, 0, points);
  add_seam_points(cut.second, 1, points);
  std::sort(points.begin(), points.end(), is_before);
  SharedPoints shared;
  shared.number[0].assign(cut.first.points_mm.size(), -1);
  shared.number[1].assign(cut.second.points_mm.size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == 0 || points[i].point_mm != points[i - 1].point_mm) {
      shared.part_vertex.push_back(points[i].mesh == 0 ? points[i].vertex : -1);
    }
    const auto number = static_cast<std::int32_t>(shared.part_vertex.size()) - 1;
    shared.number[static_cast<std::size_t>(points[i].mesh)][index(points[i].vertex)] = number;
  }
  return shared;
}

/// Directed edges of the seam by the numbers of their ends.
class SeamEdges {
 public:
  SeamEdges(const CorefinedMesh& mesh, const std::vector<std::int32_t>& number)
      : mesh_(mesh), number_(number), table_(count(mesh)) {
    for (std::size_t i = 0; i < mesh.is_seam.size(); ++i) {
      const auto corner = static_cast<std::int32_t>(i);
      if (mesh.is_seam[i] != 0) {
        is_unique_ = is_unique_ && table_.at(key(corner), corner) == corner;
      }
    }
  }

  bool is_unique() const { return is_unique_; }

  std::int32_t from(std::int32_t corner) const {
    return number_[index(vertex_at(mesh_.faces, corner))];
  }

  std::int32_t to(std::int32_t corner) const { return from(next_corner(corner)); }

  std::int32_t find(std::int32_t from, std::int32_t to) const {
    return table_.find(edge_key(from, to), -1);
  }

 private:
  static std::size_t count(const CorefinedMesh& mesh) {
    return static_cast<std::size_t>(std::count(mesh.is_seam.begin(), mesh.is_seam.end(), 1));
  }

  std::uint64_t key(std::int32_t corner) const { return edge_key(from(corner), to(corner)); }

  const CorefinedMesh& mesh_;
  const std::vector<std::int32_t>& number_;
  KeyTable table_;
  bool is_unique_ = true;
};

/// The four corners of the edge that starts in a corner of the part; empty where one is missing.
std::optional<Seam::Edge> edge_at(std::int32_t corner,
                                  const SeamEdges& part,
                                  const SeamEdges& tool) {
  const std::int32_t from = part.from(corner);
  const std::int32_t to = part.to(corner);
  const Seam::Edge edge = {corner, part.find(to, from), tool.find(from, to), tool.find(to, from)};
  if (edge.right < 0 || edge.tool_left < 0 || edge.tool_right < 0) {
    return std::nullopt;
  }
  return edge;
}

/// How the four faces around an edge lie, as angles about it.
class AngleFrame {
 public:
  AngleFrame(const Vector3d& from, const Vector3d& to)
      : origin_(from), axis_((to - from).normalized()), u_(axis_.unitOrthogonal()) {
    v_ = axis_.cross(u_);
  }

  /// Of the face to which a corner belongs, by its third point.
  double angle(const CorefinedMesh& mesh, std::int32_t corner) const {
    const std::int32_t apex = vertex_at(mesh.faces, previous_corner(corner));
    const Vector3d offset = mesh.points_mm[index(apex)] - origin_;
    return std::atan2(offset.dot(v_), offset.dot(u_));
  }

 private:
  Vector3d origin_;
  Vector3d axis_;
  Vector3d u_;
  Vector3d v_;
};

double turn(double from, double to) {
  return to < from ? to - from + 2.0 * kPi : to - from;
}

/// The solid lies between the face on the right and the face on the left of an edge, counter-
/// clockwise. How deep an angle is inside (positive) or outside [rad]; clamped, so that a few clear
/// edges do not outweigh many.
double depth_in_sector(double right, double left, double angle) {
  constexpr double kClear_rad = 0.3;
  const double span = turn(right, left);
  const double at = turn(right, angle);
  const double depth = at < span ? std::min(at, span - at) : -std::min(at - span, 2.0 * kPi - at);
  return std::clamp(depth, -kClear_rad, kClear_rad);
}

/// The corner of a face whose edge runs between two vertices; -1 when there is none.
std::int32_t corner_with(const Triangle& ids, std::int32_t from, std::int32_t to) {
  for (std::int32_t k = 0; k < 3; ++k) {
    if (ids[index(k)] == from && ids[index((k + 1) % 3)] == to) {
      return k;
    }
  }
  return -1;
}

int count_loops(const Seam& seam, const CorefinedMesh& part) {
  DisjointSets sets(part.points_mm.size());
  std::vector<std::uint8_t> is_used(part.points_mm.size(), 0);
  for (const Seam::Edge& edge : seam.edges) {
    const std::int32_t from = vertex_at(part.faces, edge.left);
    const std::int32_t to = vertex_at(part.faces, next_corner(edge.left));
    is_used[index(from)] = 1;
    is_used[index(to)] = 1;
    sets.join(from, to);
  }
  int loops = 0;
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    const auto vertex = static_cast<std::int32_t>(i);
    loops += is_used[i] != 0 && sets.find(vertex) == vertex ? 1 : 0;
  }
  return loops;
}

/// The part's vertex of each of the tool's on the seam. False when one has none.
bool match_vertices(const CorefinedPair& cut, const SharedPoints& shared, Seam& seam) {
  seam.part_vertex.assign(cut.second.points_mm.size(), -1);
  for (std::size_t i = 0; i < seam.part_vertex.size(); ++i) {
    const std::int32_t number = shared.number[1][i];
    if (number >= 0) {
      seam.part_vertex[i] = shared.part_vertex[index(number)];
      if (seam.part_vertex[i] < 0) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

std::optional<Seam> match_seam(const CorefinedPair& cut) {
  const SharedPoints shared = number_points(cut);
  const SeamEdges part(cut.first, shared.number[0]);
  const SeamEdges tool(cut.second, shared.number[1]);
  if (!part.is_unique() || !tool.is_unique()) {
    return std::nullopt;
  }
  Seam seam;
  for (std::size_t i = 0; i < cut.first.is_seam.size(); ++i) {
    const auto corner = static_cast<std::int32_t>(i);
    if (cut.first.is_seam[i] == 0) {
      continue;
    }
    const std::optional<Seam::Edge> edge = edge_at(corner, part, tool);
    if (!edge) {
      return std::nullopt;
    }
    if (part.from(corner) < part.to(corner)) {
      seam.edges.push_back(*edge);
    }
  }
  if (!match_vertices(cut, shared, seam)) {
    return std::nullopt;
  }
  seam.num_loops = count_loops(seam, cut.first);
  return seam;
}

Pieces::Pieces(const CorefinedMesh& cut,
               const Ring& ring,
               std::span<const TestFace> surface,
               const EdgeMatches& edges)
    : num_cut_(static_cast<std::int32_t>(cut.faces.size())),
      in_ring_(surface.size(), 0),
      sets_(cut.faces.size() + surface.size()),
      weight_(cut.faces.size() + surface.size(), 0.0),
      has_votes_(cut.faces.size() + surface.size(), 0) {
  for (const std::int32_t face : ring.faces) {
    in_ring_[index(face)] = 1;
  }
  for (std::int32_t corner = 0; corner < 3 * static_cast<std::int32_t>(surface.size()); ++corner) {
    const std::int32_t other = edges.opposite[index(corner)];
    if (other >= 0 && !is_in_ring(corner / 3) && !is_in_ring(other / 3)) {
      sets_.join(member_of_face(corner / 3), member_of_face(other / 3));
    }
  }
  const auto num_old = static_cast<std::int32_t>(ring.vertex_ids.size());
  for (std::int32_t corner = 0; corner < 3 * num_cut_; ++corner) {
    const std::int32_t other = cut.opposite[index(corner)];
    const std::int32_t from = vertex_at(cut.faces, corner);
    const std::int32_t to = vertex_at(cut.faces, next_corner(corner));
    if (cut.is_seam[index(corner)] != 0) {
      continue;
    }
    if (other >= 0) {
      sets_.join(corner / 3, other / 3);
    } else if (from < num_old && to < num_old) {
      // The ring's border: it does not meet the other surface, so its edges are still whole.
      const std::int32_t face = ring.faces[index(cut.parent[index(corner / 3)])];
      const std::int32_t k = corner_with(
          surface[index(face)].ids, ring.vertex_ids[index(from)], ring.vertex_ids[index(to)]);
      const std::int32_t beyond = k < 0 ? -1 : edges.opposite[index(3 * face + k)];
      if (beyond >= 0 && !is_in_ring(beyond / 3)) {
        sets_.join(corner / 3, member_of_face(beyond / 3));
      }
    }
  }
}

void Pieces::vote(std::int32_t cut_face, double weight) {
  weight_[place_of(cut_face)] += weight;
  has_votes_[place_of(cut_face)] = 1;
}

void vote_along(const Seam& seam, const CorefinedPair& cut, Pieces& part, Pieces& tool) {
  for (const Seam::Edge& edge : seam.edges) {
    const Vector3d& from = cut.first.points_mm[index(vertex_at(cut.first.faces, edge.left))];
    const Vector3d& to =
        cut.first.points_mm[index(vertex_at(cut.first.faces, next_corner(edge.left)))];
    const double length_mm = (to - from).norm();
    const AngleFrame frame(from, to);
    const double left = frame.angle(cut.first, edge.left);
    const double right = frame.angle(cut.first, edge.right);
    const double tool_left = frame.angle(cut.second, edge.tool_left);
    const double tool_right = frame.angle(cut.second, edge.tool_right);
    part.vote(edge.left / 3, length_mm * depth_in_sector(tool_right, tool_left, left));
    part.vote(edge.right / 3, length_mm * depth_in_sector(tool_right, tool_left, right));
    tool.vote(edge.tool_left / 3, length_mm * depth_in_sector(right, left, tool_left));
    tool.vote(edge.tool_right / 3, length_mm * depth_in_sector(right, left, tool_right));
  }
}

bool breaks_through(const Seam& seam, Pieces& part, Pieces& tool) {
  std::vector<std::int32_t> part_of(tool.num_members(), -1);
  std::vector<std::int32_t> tool_of(part.num_members(), -1);
  for (const Seam::Edge& edge : seam.edges) {
    for (const std::int32_t p : {edge.left / 3, edge.right / 3}) {
      for (const std::int32_t t : {edge.tool_left / 3, edge.tool_right / 3}) {
        if (!part.is_inside(p) || !tool.is_inside(t)) {
          continue;
        }
        const std::int32_t part_piece = part.piece_of(p);
        const std::int32_t tool_piece = tool.piece_of(t);
        std::int32_t& first_part = part_of[index(tool_piece)];
        std::int32_t& first_tool = tool_of[index(part_piece)];
        if ((first_part >= 0 && first_part != part_piece) ||
            (first_tool >= 0 && first_tool != tool_piece)) {
          return true;
        }
        first_part = part_piece;
        first_tool = tool_piece;
      }
    }
  }
  return false;
}

}  // namespace glint

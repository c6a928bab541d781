// SPDX-License-Identifier: GPL-3.0-or-later
//
// After corefinement: which pieces of the part lie inside the tool and which pieces of the tool
// inside the part.
#pragma once

#include <optional>

#include "core/disjoint_sets.h"
#include "defects/boolean/patch_ring.h"

namespace glint {

/// The seam: edges and vertices that both cut surfaces have.
struct Seam {
  /// One edge of the seam by the corners in which it starts: `left` runs as `from` to `to` in the
  /// part, `right` back; tool_left runs as `left` does.
  struct Edge {
    std::int32_t left = 0;
    std::int32_t right = 0;
    std::int32_t tool_left = 0;
    std::int32_t tool_right = 0;
  };

  std::vector<Edge> edges;
  /// Per vertex of the cut tool, the vertex of the cut part it is; -1 beside the seam.
  std::vector<std::int32_t> part_vertex;
  int num_loops = 0;  ///< connected pieces
};

/// Empty when part and tool do not agree about the seam, or it ends at a border.
std::optional<Seam> match_seam(const CorefinedPair& cut);

/// A surface of which the ring is cut: faces of the cut ring and faces beside the ring, joined to
/// pieces across all edges but the seam. Members: first faces of the cut ring, then all faces of
/// the surface (those of the ring stand alone there).
class Pieces {
 public:
  Pieces(const CorefinedMesh& cut,
         const Ring& ring,
         std::span<const TestFace> surface,
         const EdgeMatches& edges);

  /// The member of a face of the surface that is not in the ring.
  std::int32_t member_of_face(std::int32_t face) const { return num_cut_ + face; }

  std::int32_t piece_of(std::int32_t member) { return sets_.find(member); }

  bool is_in_ring(std::int32_t face) const { return in_ring_[static_cast<std::size_t>(face)] != 0; }

  std::size_t num_members() const { return in_ring_.size() + static_cast<std::size_t>(num_cut_); }

  /// A vote of one edge of the seam; positive: inside the other body.
  void vote(std::int32_t cut_face, double weight);

  bool has_votes(std::int32_t member) { return has_votes_[place_of(member)] != 0; }

  bool is_inside(std::int32_t member) { return weight_[place_of(member)] > 0.0; }

 private:
  std::size_t place_of(std::int32_t member) { return static_cast<std::size_t>(piece_of(member)); }

  std::int32_t num_cut_ = 0;
  std::vector<std::uint8_t> in_ring_;
  DisjointSets sets_;
  std::vector<double> weight_;
  std::vector<std::uint8_t> has_votes_;
};

/// Every edge of the seam votes for the four pieces that meet there.
void vote_along(const Seam& seam, const CorefinedPair& cut, Pieces& part, Pieces& tool);

/// Does a piece of the tool inside the part join several pieces of the part inside the tool (a
/// tunnel), or the other way round (a piece is cut off)?
bool breaks_through(const Seam& seam, Pieces& part, Pieces& tool);

}  // namespace glint

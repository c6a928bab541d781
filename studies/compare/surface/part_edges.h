// SPDX-License-Identifier: GPL-3.0-or-later
//
// Offsets told apart by the edge of the part that they belong to: a bore that is off, where the
// outline is right, is another fault than a part that lies elsewhere.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "metrics/overlap/boundary_distance.h"

namespace glint {

/// One closed outline of the simulated part, one of its holes, or a line within it. Where the
/// simulated surface is known: a piece of these along one surface, or where two surfaces meet.
struct PartEdge {
  /// "outline 1", "hole 1", "line 1", "crease 1", "edge of light 1": each kind the longest first
  std::string name;
  std::string surface;  ///< whose edge it is: shape_name(); empty: not known
  std::string beyond;   ///< on its other side: "background" or a surface; of light the same one
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();  ///< mean of its points
  std::size_t points = 0;                               ///< with a counterpart, about one a pixel
  double mean_px = 0.0;                                 ///< mean distance of the real edge
  double offset_px = 0.0;                               ///< mean along the normals: > 0 outside
  /// How far the real edge is moved as a whole, least squares over the normals; 0 where the edge
  /// runs one way only.
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
  double sigma_px = 0.0;  ///< of offset_px, by blocks of neighbours; 0 with less than four of them
  // Of edges whose surface is known:
  double length_mm = 0.0;  ///< in space, as far as it has a counterpart
  double offset_mm = 0.0;  ///< offset_px at the edge's distance from the camera
  Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();  ///< in the scene's frame
};

/// "outline" or "hole" of closed boundaries whose normals point away from the part, else "line".
const char* kind_of_boundary(const Boundary& boundary);

/// The mean figures of some points, without a name.
/// @param gaps  at least one, in the order along their edge
PartEdge edge_of_gaps(std::span<const BoundaryGap* const> gaps);

/// Of each located piece the rough boundary that it was found at.
std::vector<std::size_t> rough_of_pieces(std::span<const Boundary> rough,
                                         std::span<const Boundary> located);

/// `name` of edges that are no part of the outline, before they are numbered: where two surfaces
/// meet, and where a light or a shadow ends on one.
inline constexpr const char* kCrease = "crease";
inline constexpr const char* kEdgeOfLight = "edge of light";

/// What a list of edges leaves out.
struct UnlistedEdges {
  std::size_t count = 0;
  /// Of the outline's points with a counterpart those that belong to no edge in the list, in
  /// [0, 1]; of lines within the pictures where there is no outline.
  double outline_share = 0.0;
};

struct ListedEdges {
  std::vector<PartEdge> edges;  ///< at most 40 of at least 20 points each, the longest first
  UnlistedEdges unlisted;
};

/// Numbers edges within their kind, which `name` is. Where there are more than 40, pieces of the
/// outline go before other edges, the longest first.
/// @param outline_points  of the outline with a counterpart, at least those of its edges
ListedEdges list_edges(std::vector<PartEdge> edges, std::size_t outline_points);

/// @param rough    the part's outlines, closed, or lines that end
/// @param located  the same where they were located, in pieces
/// @param gaps     from the located boundaries to the real ones
ListedEdges part_edges(std::span<const Boundary> rough,
                       std::span<const Boundary> located,
                       std::span<const BoundaryGap> gaps);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "defects/boolean/corefine_general.h"
#include "defects/boolean/patch_edges.h"

namespace glint {

/// A crossing of an edge with a face of the other surface, in the edge's list.
struct EdgeNode {
  std::int32_t edge = 0;  ///< the smaller of its two corners
  double position = 0.0;  ///< 0..1 from that corner on
  std::int32_t node = 0;
};

/// A piece of the seam in a face.
struct FaceSegment {
  std::int32_t face = 0;
  std::int32_t from = 0;
  std::int32_t to = 0;
};

/// One surface with what is found on it.
struct CutSide {
  explicit CutSide(const GeneralSurface& general)
      : surface(general), edges(match_edges(general.mesh.faces)) {}

  /// Both corners of an edge give the same name.
  std::int32_t edge_of(std::int32_t corner) const {
    const std::int32_t other = edges.opposite[static_cast<std::size_t>(corner)];
    return other >= 0 && other < corner ? other : corner;
  }

  const Eigen::Vector3d& point(std::int32_t corner) const {
    return surface.mesh.points_mm[static_cast<std::size_t>(vertex_at(surface.mesh.faces, corner))];
  }

  const GeneralSurface& surface;
  EdgeMatches edges;
  std::vector<EdgeNode> nodes;
  std::vector<FaceSegment> segments;
};

/// Where two surfaces cross.
struct SurfaceCrossings {
  SurfaceCrossings(const GeneralSurface& a, const GeneralSurface& b) : first(a), second(b) {}

  CutSide first;
  CutSide second;
  std::vector<Eigen::Vector3d> points_mm;  ///< per node
};

/// Nodes in the order of their edges, segments in that of their faces. Empty where a corner of one
/// surface lies on the other, edges meet, or nodes are too close to be ordered.
std::optional<SurfaceCrossings> find_crossings(
    const GeneralSurface& first,
    const GeneralSurface& second,
    const std::vector<std::pair<std::int32_t, std::int32_t>>& pairs);

}  // namespace glint

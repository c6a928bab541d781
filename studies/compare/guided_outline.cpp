// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/guided_outline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "metrics/overlap/boundary_distance.h"
#include "metrics/overlap/edge_location.h"
#include "metrics/overlap/outline.h"
#include "metrics/overlap/outline_motion.h"

namespace glint::compare_detail {
namespace {

constexpr double kOwnReachPx = 3.0;   ///< from the renderer's outline to the edge in its picture
constexpr double kOwnMostPx = 1.5;    ///< farther ones are edges of light
constexpr double kRealReachPx = 4.0;  ///< from the moved outline
constexpr double kScalePx = 0.5;      ///< what the motion as a whole leaves, about
constexpr int kShifts = 3;            ///< rounds of a shift alone
constexpr int kMotions = 6;           ///< of the whole motion
constexpr int kLocations = 2;
constexpr std::size_t kLeastEdges = 40;
constexpr double kLeastShare = 0.3;

std::vector<EdgeOffset> offsets_of(const std::vector<BoundaryGap>& gaps) {
  std::vector<EdgeOffset> offsets;
  for (const BoundaryGap& gap : gaps) {
    offsets.push_back(
        {.at_px = gap.from.at_px, .normal = gap.from.normal, .offset_px = gap.offset_px});
  }
  return offsets;
}

/// Edges of the simulated picture on the renderer's outline.
std::vector<LocatedEdge> own_edges(const ImageF& picture, const std::vector<Boundary>& outline) {
  std::vector<LocatedEdge> edges = locate_edges(picture, outline, {.reach_px = kOwnReachPx});
  std::erase_if(edges,
                [](const LocatedEdge& edge) { return std::abs(edge.moved_px) > kOwnMostPx; });
  return edges;
}

/// The outline moved until most of what shows of it lies on these edges. Where the part does not
/// show, nothing of the real picture belongs to it: what is near it there is not asked.
std::vector<Boundary> moved_onto(std::vector<Boundary> outline,
                                 std::vector<Boundary> shown,
                                 std::span<const Boundary> edges,
                                 double reach_px) {
  for (int round = 0; round < kShifts + kMotions; ++round) {
    const auto gaps = gaps_between(shown, edges, reach_px);
    const OutlineMotion motion = fit_outline_motion(offsets_of(gaps), kScalePx, round < kShifts);
    shown = moved_outlines(std::move(shown), motion);
    outline = moved_outlines(std::move(outline), motion);
  }
  return outline;
}

/// Those at points where the other picture has an edge of the same sign.
std::vector<LocatedEdge> edges_alike(std::vector<LocatedEdge> edges,
                                     std::span<const LocatedEdge> other) {
  std::erase_if(edges, [&](const LocatedEdge& edge) {
    const auto key = [](const LocatedEdge& e) { return std::pair(e.boundary, e.point); };
    const auto same = std::ranges::lower_bound(other, key(edge), {}, key);
    return same == other.end() || key(*same) != key(edge) || same->contrast * edge.contrast <= 0.0;
  });
  return edges;
}

/// The motion from the points where the search began to the edges that were found.
OutlineMotion motion_of(const std::vector<Boundary>& outline, std::span<const LocatedEdge> edges) {
  std::vector<EdgeOffset> offsets;
  for (const LocatedEdge& edge : edges) {
    offsets.push_back({.at_px = outline[edge.boundary].points[edge.point].at_px,
                       .normal = edge.edge.normal,
                       .offset_px = edge.moved_px});
  }
  return fit_outline_motion(offsets, kScalePx);
}

}  // namespace

std::optional<GuidedOutlines> guided_outlines(const ImageF& simulated,
                                              const ImageF& real,
                                              const Mask& truth,
                                              std::span<const Boundary> first,
                                              double reach_px) {
  GuidedOutlines found = {.simulated_rough = outlines_of(truth, 1)};
  const std::vector<LocatedEdge> own = own_edges(simulated, found.simulated_rough);
  if (own.size() < kLeastEdges) {
    return std::nullopt;
  }
  found.simulated = joined(own, found.simulated_rough);
  found.real_rough = moved_onto(found.simulated_rough, found.simulated, first, reach_px);
  std::vector<LocatedEdge> edges;
  for (int round = 0; round <= kLocations; ++round) {
    edges = edges_alike(locate_edges(real, found.real_rough, {.reach_px = kRealReachPx}), own);
    if (round < kLocations) {
      const OutlineMotion motion = motion_of(found.real_rough, edges);
      found.real_rough = moved_outlines(std::move(found.real_rough), motion);
    }
  }
  // An edge that one side lacks has no counterpart: the nearest one would be of another side.
  found.simulated = joined(edges_alike(own, edges), found.simulated_rough);
  found.real = joined(edges, found.real_rough);
  found.share = static_cast<double>(edges.size()) / static_cast<double>(own.size());
  return edges.size() >= kLeastEdges && found.share >= kLeastShare ? std::optional(found)
                                                                   : std::nullopt;
}

}  // namespace glint::compare_detail

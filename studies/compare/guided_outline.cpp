// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/guided_outline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/median.h"
#include "metrics/overlap/boundary_distance.h"
#include "metrics/overlap/edge_location.h"
#include "metrics/overlap/outline.h"
#include "metrics/overlap/outline_motion.h"

namespace glint::compare_detail {
namespace {

/// From an outline to the edge in a picture. One for both sides: profiles that end elsewhere would
/// be fitted otherwise, and equal pictures would differ.
constexpr double kReachPx = 4.0;
/// From the renderer's outline; edges farther off are edges of light.
constexpr double kOwnMostPx = 1.5;
constexpr double kScalePx = 0.5;  ///< what the motion as a whole leaves, about
constexpr int kShifts = 3;        ///< rounds of a shift alone
constexpr int kMotions = 6;       ///< of the whole motion
constexpr int kLocations = 2;
constexpr double kAlikePx = 1.5;        ///< from the motion as a whole
constexpr double kAlikeContrast = 3.0;  ///< of the median ratio of contrasts, at most
constexpr double kFarPx = 3.0;          ///< a shift as a whole that a search along normals may miss
constexpr std::size_t kMinEdges = 40;
constexpr double kMinFound = 0.3;

std::vector<EdgeOffset> offsets_of(const std::vector<BoundaryGap>& gaps) {
  std::vector<EdgeOffset> offsets;
  for (const BoundaryGap& gap : gaps) {
    offsets.push_back(
        {.at_px = gap.from.at_px, .normal = gap.from.normal, .offset_px = gap.offset_px});
  }
  return offsets;
}

/// Edges of the simulated picture on the renderer's outline.
std::vector<LocatedEdge> own_edges(const ImageF& picture, std::span<const Boundary> outline) {
  std::vector<LocatedEdge> edges = locate_edges(picture, outline, {.reach_px = kReachPx});
  std::erase_if(edges,
                [](const LocatedEdge& edge) { return std::abs(edge.moved_px) > kOwnMostPx; });
  return edges;
}

/// The outline moved until most of what shows of it lies on these edges, by shifts and then so many
/// whole motions. Where the part does not show, nothing of the real picture belongs to it: what is
/// near it there is not asked.
std::vector<Boundary> moved_onto(std::vector<Boundary> outline,
                                 std::vector<Boundary> shown,
                                 std::span<const Boundary> edges,
                                 double reach_px,
                                 int motions) {
  for (int round = 0; round < kShifts + motions; ++round) {
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
    const auto same = std::ranges::lower_bound(other, edge.start(), {}, &LocatedEdge::start);
    return same == other.end() || same->start() != edge.start() ||
           same->contrast * edge.contrast <= 0.0;
  });
  return edges;
}

/// What lies between two edges that were found from the same point of the outline.
std::vector<EdgeOffset> offsets_between(std::span<const LocatedEdge> own,
                                        std::span<const LocatedEdge> real) {
  std::vector<EdgeOffset> offsets;
  for (const LocatedEdge& edge : real) {
    const LocatedEdge& before =
        *std::ranges::lower_bound(own, edge.start(), {}, &LocatedEdge::start);
    offsets.push_back({.at_px = before.edge.at_px,
                       .normal = edge.edge.normal,
                       .offset_px = edge.edge.normal.dot(edge.edge.at_px - before.edge.at_px)});
  }
  return offsets;
}

/// Real contrast over simulated contrast of each edge, in units of their median: exposures differ.
std::vector<double> contrast_ratios(std::span<const LocatedEdge> own,
                                    std::span<const LocatedEdge> real) {
  std::vector<double> ratios;
  for (const LocatedEdge& edge : real) {
    const LocatedEdge& before =
        *std::ranges::lower_bound(own, edge.start(), {}, &LocatedEdge::start);
    ratios.push_back(edge.contrast / before.contrast);
  }
  const double middle = ratios.empty() ? 1.0 : median(ratios);
  for (double& ratio : ratios) {
    ratio /= middle;
  }
  return ratios;
}

/// Edges whose offsets are about those of the motion as a whole and whose contrasts are about as in
/// the simulated picture: else the rim of a bright face could pass for that of the dark face beside
/// it, and the whole outline be squeezed onto it.
std::size_t count_alike(std::span<const EdgeOffset> offsets,
                        std::span<const double> contrasts,
                        const OutlineMotion& motion) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const EdgeOffset& edge = offsets[i];
    const double moved = edge.normal.dot(motion.moved(edge.at_px) - edge.at_px);
    const bool is_near = std::abs(edge.offset_px - moved) < kAlikePx;
    if (is_near && contrasts[i] < kAlikeContrast && contrasts[i] > 1.0 / kAlikeContrast) {
      ++count;
    }
  }
  return count;
}

/// Where a search along an outline ends.
struct Located {
  std::vector<Boundary> rough;  ///< moved onto the edges as a whole
  std::vector<LocatedEdge> edges;
  std::size_t alike = 0;  ///< edges that lie where the motion as a whole has them
  OutlineMotion motion;
};

/// Both sides are searched from the same points of one outline, the real one's moved by what lies
/// between the edges: what the search does to an edge it does to both, and of equal pictures
/// nothing is left.
/// @param start  the outline, moved about onto the real part
Located located_along(std::vector<Boundary> start,
                      const std::vector<Boundary>& outline,
                      const ImageF& real,
                      std::span<const LocatedEdge> own) {
  Located found = {.rough = std::move(start)};
  for (int round = 0;; ++round) {
    found.edges = edges_alike(locate_edges(real, found.rough, {.reach_px = kReachPx}), own);
    const std::vector<EdgeOffset> offsets = offsets_between(own, found.edges);
    found.motion = fit_outline_motion(offsets, kScalePx);
    found.alike = count_alike(offsets, contrast_ratios(own, found.edges), found.motion);
    if (round == kLocations) {
      return found;
    }
    found.rough = moved_outlines(outline, found.motion);
  }
}

std::vector<Boundary> shifted(std::vector<Boundary> lines, const Eigen::Vector2d& by_px) {
  for (Boundary& line : lines) {
    for (BoundaryPoint& point : line.points) {
      point.at_px += by_px;
    }
  }
  return lines;
}

/// What is bright may be wrong along a whole side: the search begins where the part should be, too,
/// and where it lies as a whole when that is farther than a search along normals finds.
Located best_located(const std::vector<Boundary>& outline,
                     const ImageF& real,
                     std::span<const LocatedEdge> own,
                     std::span<const Boundary> bright,
                     double reach_px,
                     const Eigen::Vector2d& shift_px) {
  std::vector<Eigen::Vector2d> starts = {Eigen::Vector2d::Zero()};
  if (shift_px.norm() > kFarPx) {
    starts.push_back(shift_px);
  }
  Located best;
  const auto keep_better = [&](Located other) {
    if (best.edges.empty() || other.alike > best.alike) {
      best = std::move(other);
    }
  };
  const std::vector<Boundary> shown = joined(own, outline);
  for (const Eigen::Vector2d& start : starts) {
    const std::vector<Boundary> from = shifted(outline, start);
    keep_better(located_along(from, outline, real, own));
    for (const int motions : {0, kMotions}) {
      keep_better(located_along(
          moved_onto(from, shifted(shown, start), bright, reach_px, motions), outline, real, own));
    }
  }
  return best;
}

GuidedOutline outline_at(const std::vector<Boundary>& rough, std::span<const LocatedEdge> edges) {
  return {.rough = rough, .located = joined(edges, rough), .refined = refined(rough, edges)};
}

}  // namespace

std::optional<GuidedOutlines> guided_outlines(const ImageF& simulated,
                                              const ImageF& real,
                                              const Mask& truth,
                                              std::span<const Boundary> first,
                                              double reach_px,
                                              const Eigen::Vector2d& shift_px) {
  const std::vector<Boundary> outline = outlines_of(truth, 1);
  const std::vector<LocatedEdge> own = own_edges(simulated, outline);
  if (own.size() < kMinEdges) {
    return std::nullopt;
  }
  const Located best = best_located(outline, real, own, first, reach_px, shift_px);
  // An edge that one side lacks has no counterpart: the nearest one would be of another side.
  const GuidedOutlines found = {
      .simulated = outline_at(outline, edges_alike(own, best.edges)),
      .real = outline_at(best.rough, best.edges),
      .share = static_cast<double>(best.edges.size()) / static_cast<double>(own.size()),
      .motion = best.motion};
  return best.edges.size() >= kMinEdges && found.share >= kMinFound ? std::optional(found)
                                                                    : std::nullopt;
}

std::string untold_shift_note(const OutlineMotion& motion) {
  if (motion.is_shift_told()) {
    return "";
  }
  return fmt::format(
      "All edges that were found run along ({:.2f}, {:.2f}): how far the real part is moved along "
      "that direction is unknown, and taken as 0.",
      motion.untold.x(),
      motion.untold.y());
}

std::vector<PairedEdge> edges_along(const ImageF& simulated,
                                    const ImageF& real,
                                    std::span<const Boundary> lines,
                                    const OutlineMotion& motion) {
  const std::vector<LocatedEdge> own = own_edges(simulated, lines);
  const std::vector<Boundary> moved = moved_outlines({lines.begin(), lines.end()}, motion);
  std::vector<PairedEdge> paired;
  for (const LocatedEdge& edge :
       edges_alike(locate_edges(real, moved, {.reach_px = kReachPx}), own)) {
    const LocatedEdge& before =
        *std::ranges::lower_bound(own, edge.start(), {}, &LocatedEdge::start);
    paired.push_back({.line = edge.boundary,
                      .point = edge.point,
                      .own = before.edge,
                      .offset_px = edge.edge.normal.dot(edge.edge.at_px - before.edge.at_px)});
  }
  return paired;
}

}  // namespace glint::compare_detail

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/part_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kMinPoints = 20;
constexpr std::size_t kMaxEdges = 40;

/// The rough boundary that a located piece was found at.
std::size_t nearest_boundary(std::span<const Boundary> rough, const Boundary& piece) {
  const Vector2d at = piece.points[piece.points.size() / 2].at_px;
  double least = std::numeric_limits<double>::infinity();
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < rough.size(); ++i) {
    for (const BoundaryPoint& point : rough[i].points) {
      const double square = (point.at_px - at).squaredNorm();
      if (square < least) {
        least = square;
        nearest = i;
      }
    }
  }
  return nearest;
}

constexpr std::size_t kBlock = 10;  ///< neighbours whose errors may be alike
constexpr std::size_t kMinBlocks = 4;

/// Standard deviation of the mean offset, by the means of whole blocks of neighbours.
double sigma_by_blocks(std::span<const BoundaryGap* const> gaps) {
  const std::size_t blocks = gaps.size() / kBlock;
  if (blocks < kMinBlocks) {
    return 0.0;
  }
  Eigen::VectorXd means = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(blocks));
  for (std::size_t i = 0; i < blocks * kBlock; ++i) {
    means[static_cast<Eigen::Index>(i / kBlock)] += gaps[i]->offset_px / kBlock;
  }
  const auto count = static_cast<double>(blocks);
  return std::sqrt((means.array() - means.mean()).square().sum() / (count * (count - 1.0)));
}

/// Of edges that have no number yet.
bool is_of_outline(const PartEdge& edge) {
  return edge.name != kCrease && edge.name != kEdgeOfLight;
}

}  // namespace

// Normals point away from an outline's middle, and to that of a hole.
const char* kind_of_boundary(const Boundary& boundary) {
  if (!boundary.is_closed) {
    return "line";
  }
  Vector2d middle = Vector2d::Zero();
  for (const BoundaryPoint& point : boundary.points) {
    middle += point.at_px / static_cast<double>(boundary.points.size());
  }
  double outward = 0.0;
  for (const BoundaryPoint& point : boundary.points) {
    outward += point.normal.dot(point.at_px - middle);
  }
  return outward > 0.0 ? "outline" : "hole";
}

PartEdge edge_of_gaps(std::span<const BoundaryGap* const> gaps) {
  PartEdge edge = {.points = gaps.size(), .sigma_px = sigma_by_blocks(gaps)};
  const auto count = static_cast<double>(gaps.size());
  Eigen::Matrix2d normals = Eigen::Matrix2d::Zero();
  Vector2d right = Vector2d::Zero();
  for (const BoundaryGap* gap : gaps) {
    edge.middle_px += gap->from.at_px / count;
    edge.mean_px += gap->distance_px / count;
    edge.offset_px += gap->offset_px / count;
    normals += gap->from.normal * gap->from.normal.transpose() / count;
    right += gap->from.normal * gap->offset_px / count;
  }
  constexpr double kBothWays = 0.02;  ///< of the smaller direction's share
  if (normals.determinant() > kBothWays) {
    edge.shift_px = normals.ldlt().solve(right);
  }
  return edge;
}

std::vector<std::size_t> rough_of_pieces(std::span<const Boundary> rough,
                                         std::span<const Boundary> located) {
  std::vector<std::size_t> belongs_to;
  for (const Boundary& piece : located) {
    belongs_to.push_back(rough.empty() ? 0 : nearest_boundary(rough, piece));
  }
  return belongs_to;
}

ListedEdges list_edges(std::vector<PartEdge> edges, std::size_t outline_points) {
  const std::size_t count = edges.size();
  std::erase_if(edges, [](const PartEdge& edge) { return edge.points < kMinPoints; });
  std::ranges::stable_sort(edges, std::greater<>(), [](const PartEdge& edge) {
    return std::pair(is_of_outline(edge), edge.points);
  });
  edges.resize(std::min(edges.size(), kMaxEdges));
  std::ranges::stable_sort(edges, std::greater<>(), &PartEdge::points);
  std::map<std::string, int> numbers;
  std::size_t listed_points = 0;
  for (PartEdge& edge : edges) {
    listed_points += is_of_outline(edge) ? edge.points : 0;
    edge.name = fmt::format("{} {}", edge.name, ++numbers[edge.name]);
  }
  UnlistedEdges unlisted = {.count = count - edges.size()};
  if (outline_points > 0) {
    unlisted.outline_share =
        1.0 - static_cast<double>(listed_points) / static_cast<double>(outline_points);
  }
  return {.edges = std::move(edges), .unlisted = unlisted};
}

ListedEdges part_edges(std::span<const Boundary> rough,
                       std::span<const Boundary> located,
                       std::span<const BoundaryGap> gaps) {
  const std::vector<std::size_t> belongs_to = rough_of_pieces(rough, located);
  std::map<std::size_t, std::vector<const BoundaryGap*>> of_boundary;
  for (const BoundaryGap& gap : gaps) {
    of_boundary[belongs_to[gap.boundary]].push_back(&gap);
  }
  std::vector<PartEdge> edges;
  for (const auto& [boundary, some] : of_boundary) {
    if (boundary < rough.size()) {
      edges.push_back(edge_of_gaps(some));
      edges.back().name = kind_of_boundary(rough[boundary]);
    }
  }
  return list_edges(std::move(edges), gaps.size());
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/part_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kLeastPoints = 20;
constexpr std::size_t kMostEdges = 40;

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

/// Normals point away from an outline's middle, and to that of a hole.
const char* kind_of(const Boundary& boundary) {
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

PartEdge edge_of(const std::vector<const BoundaryGap*>& gaps) {
  PartEdge edge{.points = gaps.size()};
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

}  // namespace

std::vector<PartEdge> part_edges(std::span<const Boundary> rough,
                                 std::span<const Boundary> located,
                                 std::span<const BoundaryGap> gaps) {
  std::vector<std::size_t> belongs_to;
  for (const Boundary& piece : located) {
    belongs_to.push_back(rough.empty() ? 0 : nearest_boundary(rough, piece));
  }
  std::map<std::size_t, std::vector<const BoundaryGap*>> of_boundary;
  for (const BoundaryGap& gap : gaps) {
    of_boundary[belongs_to[gap.boundary]].push_back(&gap);
  }
  std::vector<PartEdge> edges;
  for (const auto& [boundary, some] : of_boundary) {
    if (some.size() >= kLeastPoints && boundary < rough.size()) {
      edges.push_back(edge_of(some));
      edges.back().name = kind_of(rough[boundary]);
    }
  }
  std::ranges::stable_sort(edges, std::greater<>(), &PartEdge::points);
  edges.resize(std::min(edges.size(), kMostEdges));
  std::map<std::string, int> numbers;
  for (PartEdge& edge : edges) {
    edge.name = fmt::format("{} {}", edge.name, ++numbers[edge.name]);
  }
  return edges;
}

}  // namespace glint

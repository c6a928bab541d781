// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/inner_edges.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "metrics/overlap/edge_location.h"

namespace glint {
namespace {

constexpr std::size_t kMinPoints = 20;
/// From a line to its edge in the simulated picture; what lies farther off is another edge.
constexpr double kOwnMostPx = 4.0;

/// 3 x 3 means: lines of a level through noise would be frayed.
ImageF smoothed(const ImageF& picture) {
  ImageF result = picture;
  for (int y = 1; y + 1 < picture.height(); ++y) {
    for (int x = 1; x + 1 < picture.width(); ++x) {
      float sum = 0.0F;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          sum += picture(x + i, y + j);
        }
      }
      result(x, y) = sum / 9.0F;
    }
  }
  return result;
}

bool lies_in(const Mask& mask, const LocatedEdge& edge) {
  const int x = std::clamp(static_cast<int>(edge.edge.at_px.x()), 0, mask.width() - 1);
  const int y = std::clamp(static_cast<int>(edge.edge.at_px.y()), 0, mask.height() - 1);
  return mask(x, y) != 0;
}

/// Edges beside the lines that fall along the normals, as the lines do, and lie inside. Both
/// pictures are searched from the same points and equally far: equal ones have equal edges.
std::vector<LocatedEdge> falling_edges(const ImageF& picture,
                                       const std::vector<Boundary>& lines,
                                       const Mask& inside) {
  std::vector<LocatedEdge> edges = locate_edges(picture, lines, {.reach_px = kInnerReachPx});
  std::erase_if(edges, [&](const LocatedEdge& edge) {
    return edge.contrast <= 0.0 || (!inside.empty() && !lies_in(inside, edge));
  });
  return edges;
}

/// Those that were found from a point from which another one was found in the other picture.
std::vector<LocatedEdge> edges_of_both(std::vector<LocatedEdge> edges,
                                       const std::vector<LocatedEdge>& other) {
  std::erase_if(edges, [&](const LocatedEdge& edge) {
    return !std::ranges::binary_search(other, edge.start(), {}, &LocatedEdge::start);
  });
  return edges;
}

/// Of edges from the same points, in their order.
double mean_distance_px(const std::vector<LocatedEdge>& first,
                        const std::vector<LocatedEdge>& second) {
  double sum = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    sum += std::abs(second[i].moved_px - first[i].moved_px);
  }
  return sum / static_cast<double>(std::max<std::size_t>(first.size(), 1));
}

}  // namespace

InnerEdges inner_edges(const ImageF& simulated,
                       const ImageF& real,
                       float level,
                       const Mask& inside) {
  GLINT_CHECK(inside.empty() || inside.size() == simulated.size(), "a mask of the picture's size");
  InnerEdges found = {.lines = boundaries_at(smoothed(simulated), level, kMinPoints)};
  std::vector<LocatedEdge> own = falling_edges(simulated, found.lines, inside);
  std::erase_if(own, [](const LocatedEdge& edge) { return std::abs(edge.moved_px) > kOwnMostPx; });
  const std::vector<LocatedEdge> others =
      edges_of_both(falling_edges(real, found.lines, inside), own);
  found.points = own.size();
  own = edges_of_both(std::move(own), others);
  found.simulated = joined(own, found.lines);
  found.real = joined(others, found.lines);
  found.paired = own.size();
  found.mean_px = mean_distance_px(own, others);
  return found;
}

double InnerEdges::share() const {
  return points > 0 ? static_cast<double>(paired) / static_cast<double>(points) : 0.0;
}

double InnerEdges::distance_px() const {
  return share() * mean_px + (1.0 - share()) * kInnerReachPx;
}

}  // namespace glint

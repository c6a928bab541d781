// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/inner_edges.h"

#include <algorithm>

#include "core/error.h"
#include "metrics/overlap/edge_location.h"

namespace glint {
namespace {

constexpr std::size_t kMinPoints = 20;

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

bool lies_in(const Mask& mask, const Eigen::Vector2d& at_px) {
  const int x = std::clamp(static_cast<int>(at_px.x()), 0, mask.width() - 1);
  const int y = std::clamp(static_cast<int>(at_px.y()), 0, mask.height() - 1);
  return mask(x, y) != 0;
}

}  // namespace

InnerEdges inner_edges(const ImageF& simulated,
                       const ImageF& real,
                       float level,
                       const Mask& inside) {
  GLINT_CHECK(inside.empty() || inside.size() == simulated.size(), "a mask of the picture's size");
  InnerEdges found = {.lines = boundaries_at(smoothed(simulated), level, kMinPoints)};
  std::vector<LocatedEdge> edges = locate_edges(simulated, found.lines);
  if (!inside.empty()) {
    std::erase_if(edges,
                  [&](const LocatedEdge& edge) { return !lies_in(inside, edge.edge.at_px); });
  }
  found.simulated = joined(edges, found.lines);
  found.real =
      joined(locate_edges(real, found.simulated, {.reach_px = kInnerReachPx}), found.simulated);
  return found;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The rays through a pixel's corners cross the wall at places that are linear over the pixel, so
// each edge of the wall cuts it along a line. What is beside the wall (below its rim, beyond its
// ends) is cut off piece by piece; of the rest the camera sees the slot. docs/theory/footprints.md,
// "What the wall hides". Cost: mostly one clipped polygon; memory for at most four.
#include "simulator/render/footprint/visible_part.h"

#include <algorithm>
#include <cmath>

#include "core/image/mask_kernels.h"

namespace glint {
namespace {

/// Of an area: less is none.
constexpr double kNoArea = 1e-9;

constexpr int kBesideWall = 3;  ///< edges that something is beside of: the rim, both ends

LinearFunction minus(const LinearFunction& f) {
  return {.value = -f.value, .dx = -f.dx, .dy = -f.dy};
}

LinearFunction plus(double value, LinearFunction f) {
  f.value += value;
  return f;
}

LinearFunction linear_through(const OccludedEdge::Corners& corners) {
  return glint::linear_through({static_cast<double>(corners[0]),
                                static_cast<double>(corners[1]),
                                static_cast<double>(corners[2]),
                                static_cast<double>(corners[3])});
}

}  // namespace

VisiblePart::VisiblePart(const OccludedEdge& pixel, const TunnelSettings& tunnel) {
  const LinearFunction x = linear_through(pixel.x_mm);
  const LinearFunction y = linear_through(pixel.y_mm);
  const double half_length_mm = 0.5 * tunnel.length_mm;
  const double half_slot_mm = tunnel.half_slot_mm();
  edges_ = {linear_through(pixel.margin_mm),
            plus(half_length_mm, x),
            plus(half_length_mm, minus(x)),
            plus(half_slot_mm, y),
            plus(half_slot_mm, minus(y))};
}

LinearFunction VisiblePart::edge(int index, const SquareOfPixel& square) const {
  const LinearFunction& f = edges_[static_cast<std::size_t>(index)];
  return {.value = f.at(square.x, square.y), .dx = f.dx * square.side, .dy = f.dy * square.side};
}

std::vector<PixelPolygon> VisiblePart::polygons(const SquareOfPixel& square,
                                                int first_label) const {
  std::vector<PixelPolygon> parts;
  const auto keep = [&](const PixelPolygon& part) {
    if (part.size() > 2) {
      parts.push_back(part);
    }
  };
  PixelPolygon rest;
  for (int i = 0; i < kEdges; ++i) {
    const LinearFunction inside = edge(i, square);
    if (inside.value >= 0.5 * (std::abs(inside.dx) + std::abs(inside.dy))) {
      continue;  // it does not cross the square
    }
    const int label = first_label + 2 * i;
    if (i < kBesideWall) {
      PixelPolygon beside = rest;
      beside.clip(minus(inside), label + 1);
      keep(beside);
    }
    rest.clip(inside, label);
  }
  keep(rest);
  return parts;
}

bool VisiblePart::contains(double x, double y) const {
  const auto is_beside = [&](const LinearFunction& edge) { return edge.at(x, y) < 0.0; };
  const auto slot = edges_.begin() + kBesideWall;
  return std::any_of(edges_.begin(), slot, is_beside) ||
         std::none_of(slot, edges_.end(), is_beside);
}

double VisiblePart::area(const SquareOfPixel& square) const {
  double sum = 0.0;
  for (const PixelPolygon& part : polygons(square)) {
    sum += part.area();
  }
  return sum;
}

double hidden_share(const OccludedPixels& occluded,
                    const TunnelSettings& tunnel,
                    const VisibilityBuffer& seen) {
  const auto& coverage = seen.coverage.values();
  const int on_part =
      mask_kernels::count_positive(coverage.data(), static_cast<int>(coverage.size()));
  double of_edges = 0.0;
  for (const OccludedEdge& pixel : occluded.edges) {
    const double hidden = 1.0 - VisiblePart(pixel, tunnel).area();
    of_edges += hidden > kNoArea ? hidden : 0.0;
  }
  return share_of_part(occluded.whole, seen) + (on_part > 0 ? of_edges / on_part : 0.0);
}

}  // namespace glint

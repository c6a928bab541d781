// SPDX-License-Identifier: GPL-3.0-or-later
//
// What of a pixel the tunnel's wall leaves to the camera: convex polygons, over which the stripes
// are integrated as over whole pixels.
#pragma once

#include <array>
#include <vector>

#include "simulator/light/tunnel/tunnel_settings.h"
#include "simulator/render/footprint/stripe_integral.h"
#include "simulator/render/wall/occluded_pixels.h"

namespace glint {

/// A square of a pixel: its centre, from the pixel's, and its side [px].
struct SquareOfPixel {
  double x = 0.0;
  double y = 0.0;
  double side = 1.0;
};

class VisiblePart {
 public:
  /// Edges of the wall: rim, ends (two), slot (two).
  static constexpr int kEdges = 5;

  /// @param tunnel  whose wall it is
  VisiblePart(const OccludedEdge& pixel, const TunnelSettings& tunnel);

  /// A function over the square that is >= 0 on the wall's side of the rim and the ends, and on the
  /// slot's side of the slot's edges.
  LinearFunction edge(int index, const SquareOfPixel& square = {}) const;

  /// Disjoint polygons in the square's coordinates, from -1/2 to 1/2. An edge that edge(i) has made
  /// has the label first_label + 2 i where it is >= 0 inside, one more where it is < 0.
  std::vector<PixelPolygon> polygons(const SquareOfPixel& square = {}, int first_label = 0) const;

  /// Whether the camera sees a point of the pixel, -1/2 to 1/2 from its centre.
  bool contains(double x, double y) const;

  /// The share of the square that is seen.
  double area(const SquareOfPixel& square = {}) const;

 private:
  std::array<LinearFunction, kEdges> edges_;
};

/// Share of the part's pixels that the wall hides from the camera; pixels hidden in part count in
/// part.
double hidden_share(const OccludedPixels& occluded,
                    const TunnelSettings& tunnel,
                    const VisibilityBuffer& seen);

}  // namespace glint

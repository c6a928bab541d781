// SPDX-License-Identifier: GPL-3.0-or-later
//
// The counterpart of simulator/render/footprint/cell_sum.h: what the cells of a pixel change,
// in reverse mode.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/render/derivative/stripe_gradient.h"
#include "simulator/render/footprint/cell_sum.h"
#include "simulator/render/footprint/visible_part.h"

namespace glint {

/// Derivatives of a number by the hits at the corners of a cell.
struct CornerGradient {
  std::array<double, 4> x = {}, y = {}, margin = {};
};

/// Collects what does not belong to single corners.
class CellGradient {
 public:
  explicit CellGradient(const ScanPositions& positions);

  /// A smooth cell, `share` of the pixel. Cells inside the light wait for finish(); the derivatives
  /// of others are added at once. @param by_radiance  derivative by the pixel's radiance in each
  /// frame
  /// @param add  gets (corner 0 to 3 of the cell, CornerGradient of it)
  template <class Add>
  void add_smooth(const CellCorners& corners,
                  const std::array<std::size_t, 4>& at,
                  double share,
                  const std::vector<double>& by_radiance,
                  const Add& add) {
    CornerGradient gradient;
    if (!waits(corners, at, share) && is_boundary(corners, share, by_radiance, gradient)) {
      add(at, gradient);
    }
  }

  /// A smooth cell of which the wall hides a part from the camera. What the edges of that part
  /// change is collected in by_edges. @param square  that the cell is of the pixel
  template <class Add>
  void add_visible(const CellCorners& corners,
                   const std::array<std::size_t, 4>& at,
                   const VisiblePart& visible,
                   const SquareOfPixel& square,
                   const std::vector<double>& by_radiance,
                   const Add& add) {
    CornerGradient gradient;
    if (is_visible(corners, visible, square, by_radiance, gradient)) {
      add(at, gradient);
    }
  }

  /// By VisiblePart::edge() of the pixel; to be cleared for the next one.
  std::array<LinearGradient, VisiblePart::kEdges> by_edges;

  /// The waiting cells of a pixel.
  template <class Add>
  void finish(const std::vector<double>& by_radiance, const Add& add) {
    for (const Waiting& cell : waiting_) {
      add(cell.at, gradient_of_waiting(cell, by_radiance));
    }
    waiting_.clear();
  }

  double duty = 0.0;
  double dark = 0.0;
  double slot_mm = 0.0;
  double period_mm = 0.0;
  double offset_mm = 0.0;
  bool has_detached = false;  ///< the tunnel's end or no wall at a corner: taken as fixed

 private:
  /// A cell inside the light at all positions.
  struct Waiting {
    std::array<std::size_t, 4> at = {};
    LinearFunction phase;
    double gain = 0.0;
  };

  bool waits(const CellCorners& corners, const std::array<std::size_t, 4>& at, double share);
  bool is_boundary(const CellCorners& corners,
                   double share,
                   const std::vector<double>& by_radiance,
                   CornerGradient& gradient);
  bool is_visible(const CellCorners& corners,
                  const VisiblePart& visible,
                  const SquareOfPixel& square,
                  const std::vector<double>& by_radiance,
                  CornerGradient& gradient);
  bool is_detached(const CellCorners& corners);
  StripeGradient gradient_of_polygons(const CellCorners& corners,
                                      std::span<const PixelPolygon> parts,
                                      std::span<LinearFunction> boundaries,
                                      double share,
                                      const std::vector<double>& by_radiance);
  void add_polygons(const CellCorners& corners,
                    const StripeGradient& sums,
                    CornerGradient& gradient);
  CornerGradient gradient_of_waiting(const Waiting& cell, const std::vector<double>& by_radiance);
  LinearFunction phase_of(const CellCorners& corners) const;
  void add_stripes(const LinearFunction& phase,
                   const LinearGradient& by_phase,
                   CornerGradient& gradient);

  const ScanPositions& p_;
  std::vector<Waiting> waiting_;
  // A waiting cell, frame by frame, as many as fill whole vectors:
  std::vector<gradient_kernels::FixedPhase> shifts_, v_;
  std::vector<float> gx_, gy_, weight_;
  std::vector<float> by_v_, by_gx_, by_gy_, by_duty_, by_dark_;
  std::vector<double> weights_;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The radiance of one pixel at all positions of a scan, summed from cells.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "simulator/render/footprint/cell_samples.h"
#include "simulator/render/footprint/footprints.h"
#include "simulator/render/footprint/stripe_integral.h"

namespace glint {

/// Lower margins are no places on the wall.
inline constexpr double kNoHitBelow_mm = -1e20;

/// Hits at the corners (x0 y0, x1 y0, x0 y1, x1 y1) of a cell.
struct CellCorners {
  std::array<double, 4> x_mm = {}, stripes_mm = {}, y_mm = {}, margin_mm = {};
  std::array<double, 4> gain = {};

  CellCorners(const WallHits& hits, const float* weight, const std::array<std::size_t, 4>& at);

  double mean_gain() const { return 0.25 * (gain[0] + gain[1] + gain[2] + gain[3]); }
};

/// Collects the cells of a pixel. Cells inside the light become samples that are summed 16 at a
/// time, those on its boundaries are integrated over polygons.
class CellSum {
 public:
  explicit CellSum(const ScanPositions& positions);

  void clear();

  /// A cell that its corners describe, `share` of the pixel.
  void add_smooth(const CellCorners& corners, double share);

  /// The same of which the camera sees some polygons only (visible_part.h).
  void add_visible(const CellCorners& corners, double share, std::span<const PixelPolygon> visible);

  /// True when the light's boundaries pass none of the places within these limits.
  bool is_lit_throughout(const std::array<double, 2>& x_mm,
                         const std::array<double, 2>& y_mm,
                         double lowest_margin_mm) const;

  /// The smooth ones of cells of which is_lit_throughout() is known; false, and nothing added, when
  /// one of them is too wide.
  bool add_lit_cells(const cut_kernels::CellGrid& cells);

  /// What was summed up elsewhere, for each position.
  void add_radiance(std::size_t position, double radiance) { sum_[position] += radiance; }

  const ScanPositions& positions() const { return p_; }

  /// A place that stands for a part of the pixel.
  /// @param gain  of the light there, times the part
  void add_place(double x_mm, double stripes_mm, double y_mm, double margin_mm, double gain);

  /// Radiance at each position.
  const std::vector<double>& radiance();

 private:
  bool add_lit(const std::array<float, 4>& stripes_mm, float gain);
  bool is_narrow(double width_mm) const;
  void make_room(std::size_t more);
  void add_points(const CellCorners& corners, double share);
  void add_sample(float stripes_mm, float gx_mm, float gy_mm, float gain);
  void integrate(const CellCorners& corners,
                 std::span<const PixelPolygon> visible,
                 const std::vector<double>& shifts,
                 const double* tunnel_mm);
  void integrate_on_wall(const CellCorners& corners, const PixelPolygon& wall);
  LinearFunction phase_of(const CellCorners& corners) const;
  void accumulate(const CellCorners& corners,
                  double share,
                  std::size_t first,
                  const std::vector<double>& shifts);

  const ScanPositions& p_;
  std::size_t size_ = 0;                   ///< samples in use
  std::vector<float> v_, gx_, gy_, gain_;  ///< samples, with room for more
  std::vector<float> outer_, inner_, per_major_, per_both_;
  StripeSum stripes_;
  std::vector<double> shares_;
  std::vector<double> sum_;
};

/// 1 for an even tunnel, else the LEDs' ripple and the loss towards the ends, x in the tunnel.
double unevenness(const ScanPositions& positions, double x_mm);

}  // namespace glint

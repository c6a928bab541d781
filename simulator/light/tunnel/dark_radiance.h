// SPDX-License-Identifier: GPL-3.0-or-later
//
// What dark stripes of a fringe tunnel throw back of the light of the bright ones. The wall is
// diffuse and long, so its dark stripes have at the place s of the cross-section the radiance
//
//   D(s) = rho * integral over the wall of K(s, s') [duty + (1 - duty) D(s')] ds',
//   K = cos cos' / (2 r) where s sees s'
//
// the radiosity of a two-dimensional enclosure (M. F. Modest, "Radiative Heat Transfer", chapter
// 5). It is solved on pieces of equal length; what a piece's middle sees of another is the
// difference of two sines, exact for straight pieces. docs/theory/tunnel.md, "Dark stripes". Cost:
// some 0.3 ms a tunnel whose dark stripes reflect, nothing for others.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "simulator/light/tunnel/tunnel_settings.h"

namespace glint {

/// Radiance of dark stripes along the cross-section, 1 = that of bright stripes. Immutable.
class DarkRadiance {
 public:
  /// Where D varies by no more than this about its mean, the mean stands for it everywhere.
  static constexpr double kEven = 0.002;

  /// Even nodes of a part's table.
  static constexpr int kNodes = 257;

  /// A place on the cross-section: `part` 0, but for panels that lean and do not touch, whose upper
  /// halves are part 1; `at` in [0, 1] from the part's end at the rim (or the panel's end) on. On
  /// curves z / (|y| + z) with z from the base, on panels a share of a power of two in mm: so what
  /// a key changes of the wall does not move the nodes.
  struct Place {
    int part = 0;
    double at = 0.0;         ///< in [0, 1]
    double by_y = 0.0;       ///< derivative of `at` by |y| [1 / mm]
    double by_margin = 0.0;  ///< ... by the margin [1 / mm]
  };

  /// Black stripes.
  DarkRadiance() = default;

  /// @param half_yz_mm  the wall at y <= 0 as a polyline of (y, z) from its rim to the middle, the
  ///                    slot cut off; fewer than two points: black
  /// @param panel_mm    length of a flat tunnel's panel; other shapes: 0
  /// @param touch       flat: whether the panels' upper ends touch
  DarkRadiance(const TunnelSettings& settings,
               const std::vector<Eigen::Vector2d>& half_yz_mm,
               double panel_mm,
               bool touch);

  /// True when mean() stands for all places.
  bool is_even() const { return nodes_.empty(); }

  double mean() const { return mean_; }  ///< over the wall, in [0, 1)

  /// @return mean() for an even wall
  double lowest() const { return lowest_; }

  double highest() const { return highest_; }

  /// The wall's view factor to itself: the share of what it throws off that it meets again.
  double view_factor() const { return view_factor_; }

  /// @param y_mm, margin_mm  of a hit as Tunnel::intersect_block() gives them
  Place place_of(double y_mm, double margin_mm) const;

  /// Of an even wall its mean.
  double at(const Place& place) const;

  double at(double y_mm, double margin_mm) const { return at(place_of(y_mm, margin_mm)); }

  /// Derivative of at() by Place::at.
  double slope_at(const Place& place) const;

  /// kNodes of part 0, and where there is one of part 1; none where the wall is even.
  int num_nodes() const { return static_cast<int>(nodes_.size()); }

  /// Adds `factor` times the derivatives of at() by the nodes. @param by_nodes  num_nodes()
  void add_gradient(const Place& place, double factor, std::span<double> by_nodes) const;

  /// This wall's radiance where another one has a node: at the same distance from the panel's end.
  /// @return the mean where this wall is even
  double at_node_of(const DarkRadiance& other, int node) const;

 private:
  /// The nodes that make up a place, with what they count and how that changes by Place::at.
  struct Stencil {
    std::array<std::size_t, 4> node = {};
    std::array<double, 4> weight = {}, slope = {};
  };

  Stencil stencil_of(const Place& place) const;
  void tabulate(const std::vector<double>& along, const std::vector<double>& dark);

  double mean_ = 0.0;
  double lowest_ = 0.0;
  double highest_ = 0.0;
  double view_factor_ = 0.0;
  double panel_mm_ = 0.0;     ///< 0: not flat
  double table_mm_ = 0.0;     ///< flat: the margin at the last node, a power of two
  double middle_y_mm_ = 0.0;  ///< flat: |y| in the middle of a panel
  bool leans_ = false;        ///< flat, margins count from both ends: told apart by |y|
  std::vector<double> nodes_;
};

}  // namespace glint

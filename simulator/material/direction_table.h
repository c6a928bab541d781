// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "simulator/material/ggx.h"

namespace glint {

/// A smooth function of a direction that is mirror-symmetric in x and in y, kept at nodes and
/// interpolated by cubics.
///
/// The nodes crowd where microfacets make such functions bend: at grazing, within a cosine of a
/// fraction of the slopes' width. So the axes are log(1 + z / knee) and the width along the
/// direction's azimuth, from one principal width to the other.
class DirectionTable {
 public:
  using Function = std::function<double(const LocalDirection&)>;

  /// @param alpha     widths of the surface; equal: one column, the function must not depend on phi
  /// @param function  asked at 36 or 360 directions with z >= 0
  DirectionTable(const GgxAlpha<double>& alpha, const Function& function);

  double at(const LocalDirection& direction) const;

  /// Of the interpolated function over all directions, weighted with the cosine.
  double average() const { return average_; }

  // For kernels that repeat at().
  static constexpr int kRows = 36;

  const GgxAlpha<double>& alpha() const { return alpha_; }

  int columns() const { return columns_; }

  double knee() const { return knee_; }

  double scale() const { return scale_; }

  /// columns() times kRows.
  const std::vector<double>& values() const { return values_; }

 private:
  double z_of(double u) const;
  double value(int column, double u) const;
  double column_at(double width) const;
  double integrate() const;

  GgxAlpha<double> alpha_;
  int columns_ = 1;
  double knee_ = 1.0;           ///< rows are equal in log(1 + z / knee)
  double scale_ = 1.0;          ///< log(1 + 1 / knee)
  std::vector<double> values_;  ///< columns_ times kRows
  double average_ = 0.0;
};

/// Weights (Catmull-Rom) of the four nodes around a place x of count nodes at 0, 1, ..., with the
/// ends continued by parabolas.
struct CubicStencil {
  int first = 0;  ///< node of weights[0]; the rest follow
  std::array<double, 4> weights{};
};

/// @param x  clamped to [0, count - 1]  @param count  >= 4
CubicStencil cubic_stencil(double x, int count);

}  // namespace glint

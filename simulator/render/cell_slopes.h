// SPDX-License-Identifier: GPL-3.0-or-later
//
// The counterpart of cell_sum.h: what the cells of a pixel change, backwards.
#pragma once

#include <vector>

#include "simulator/render/cell_sum.h"

namespace glint {

/// Slopes of a number by the hits at the corners of a cell.
struct CornerSlopes {
  std::array<double, 4> x = {}, y = {}, margin = {};
};

/// Collects what does not belong to single corners.
class CellSlopes {
 public:
  explicit CellSlopes(const ScanPositions& positions);

  /// A smooth cell. @param by_radiance  slope by the pixel's radiance in each frame
  CornerSlopes of_smooth(const CellCorners& corners,
                         double share,
                         const std::vector<double>& by_radiance);

  double duty = 0.0;
  double dark = 0.0;
  double slot_mm = 0.0;
  double period_mm = 0.0;
  bool has_held = false;  ///< the tunnel's end or no wall at a corner: taken as fixed

 private:
  CornerSlopes of_plain(const LinearFunction& phase);
  CornerSlopes of_boundary(const CellCorners& corners, const LinearFunction& phase);
  void add_stripes(const LinearFunction& phase, const LinearSlopes& by_phase, CornerSlopes& slopes);

  const ScanPositions& p_;
  std::vector<double> weights_;
};

}  // namespace glint

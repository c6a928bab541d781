// SPDX-License-Identifier: GPL-3.0-or-later
//
// The widths w at which the table T(w) of clipped_mean.h is read, and where it holds: where the
// phase of the stripes is linear over the blur (docs/theory/clipped_mean.md).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "simulator/render/footprint/footprints.h"
#include "simulator/render/scan/width_kernels.h"
#include "simulator/sensor/sensor.h"

namespace glint {

/// Row by row, with the neighbours' differences at hand.
class WidthRows {
 public:
  /// @param footprints  must outlive the rows
  WidthRows(const Footprints& footprints, const Sensor& sensor);

  /// Rows are asked for in order.
  /// @param width      [periods], one for each column
  /// @param is_linear  1 where the phase is
  void find(int y, float* width, unsigned char* is_linear);

 private:
  using Ring = std::array<std::vector<float>, 3>;

  static std::size_t slot_of(int y) { return static_cast<std::size_t>(y % 3); }

  void load(int y);
  footprint_kernels::ThreeRows around(const Ring& ring, int y) const;

  const Footprints& footprints_;
  int columns_;
  int last_;
  footprint_kernels::LinearPhase rule_;
  Ring gx_;
  Ring gy_;
};

}  // namespace glint

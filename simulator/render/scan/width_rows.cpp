// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan/width_rows.h"

#include <algorithm>

namespace glint {

namespace kernels = footprint_kernels;

namespace {

/// Second differences of the phase that the table bears (docs/theory/clipped_mean.md).
constexpr float kAbsoluteBend = 2e-3F;
constexpr float kRelativeBend = 0.25F;

/// Variance of a box pixel [px^2].
constexpr double kBoxVariance = 1.0 / 12.0;

}  // namespace

WidthRows::WidthRows(const Footprints& footprints, const Sensor& sensor)
    : footprints_(footprints),
      columns_(footprints.rays().width_px),
      last_(footprints.rays().height_px - 1),
      rule_{.variance_px2 = static_cast<float>(sensor.blur_variance_px2() + kBoxVariance),
            .absolute = kAbsoluteBend,
            .relative = kRelativeBend} {
  for (std::size_t slot = 0; slot < 3; ++slot) {
    gx_[slot].resize(static_cast<std::size_t>(columns_));
    gy_[slot].resize(static_cast<std::size_t>(columns_));
  }
}

void WidthRows::find(int y, float* width, unsigned char* is_linear) {
  if (y == 0) {
    load(0);
  }
  if (y < last_) {
    load(y + 1);
  }
  kernels::stripe_widths(around(gx_, y), around(gy_, y), columns_, rule_, width, is_linear);
}

void WidthRows::load(int y) {
  const std::ptrdiff_t corner_width = columns_ + 1;
  const float* top = footprints_.hits().stripes_mm().data() + y * corner_width;
  kernels::phase_differences({.top = top, .bottom = top + corner_width},
                             columns_,
                             static_cast<float>(1.0 / footprints_.positions().period_mm),
                             gx_[slot_of(y)].data(),
                             gy_[slot_of(y)].data());
}

kernels::ThreeRows WidthRows::around(const Ring& ring, int y) const {
  return {.above = ring[slot_of(std::max(0, y - 1))].data(),
          .here = ring[slot_of(y)].data(),
          .below = ring[slot_of(std::min(last_, y + 1))].data()};
}

}  // namespace glint

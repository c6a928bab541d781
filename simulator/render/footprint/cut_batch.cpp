// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/cut_batch.h"

#include <algorithm>

namespace glint {

void CutBatch::load(const WallHits& hits,
                    const float* weight,
                    std::size_t first,
                    std::int32_t below,
                    std::span<const std::int32_t> corners) {
  corners_.count = static_cast<int>(std::min<std::size_t>(cut_kernels::kBatch, corners.size()));
  const auto read = [&](const float* values, cut_kernels::Corners& to) {
    cut_kernels::gather(values, corners.data(), below, corners_.count, to);
  };
  read(hits.x_mm.data() + first, corners_.x_mm);
  read(hits.y_mm.data() + first, corners_.y_mm);
  read(hits.margin_mm.data() + first, corners_.margin_mm);
  read(weight, corners_.gain);
  if (!hits.cosine.empty()) {
    read(hits.cosine.data() + first, corners_.stripes_mm);
    cut_kernels::scale(corners_.stripes_mm, corners_.count, corners_.gain);
  }
  if (hits.pattern_mm.empty()) {
    corners_.stripes_mm = corners_.x_mm;
  } else {
    read(hits.pattern_mm.data() + first, corners_.stripes_mm);
  }
  is_simple_.fill(0);
}

void CutBatch::find_cuts(const cut_kernels::CutLimits& limits) {
  cut_kernels::find_cuts(corners_, limits, inside_, is_simple_.data());
}

void CutBatch::cut(const ScanPositions& positions) {
  cut_kernels::cut(corners_, inside_, positions.offset_mm, 1.0 / positions.period_mm, sums_);
}

void CutBatch::integrate(const ScanPositions& positions,
                         std::size_t position,
                         float* radiance) const {
  cut_kernels::integrate(corners_,
                         sums_,
                         {.shift = positions.shift_periods[position],
                          .duty = positions.duty,
                          .dark = positions.dark,
                          .bright = positions.bright},
                         radiance);
}

}  // namespace glint

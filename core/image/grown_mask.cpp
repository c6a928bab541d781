// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/grown_mask.h"

#include <algorithm>

#include "core/image/mask_kernels.h"

namespace glint {

RowGrower::RowGrower(int width_px, int radius_px)
    : width_px_(width_px),
      radius_px_(radius_px),
      scratch_(2 * static_cast<std::size_t>(width_px + 2 * radius_px)) {}

void RowGrower::grow(const Mask& mask, int y, unsigned char* row) {
  rows_.clear();
  const int last = std::min(mask.height() - 1, y + radius_px_);
  for (int from = std::max(0, y - radius_px_); from <= last; ++from) {
    rows_.push_back(mask.row(from));
  }
  mask_kernels::grow_row(
      rows_.data(), static_cast<int>(rows_.size()), width_px_, radius_px_, scratch_.data(), row);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include "simulator/render/corner_rays/sparse_kernels.h"
#include "simulator/render/corner_rays/sparse_rays.h"

namespace glint {

/// Nodes that a plane has more on each side: a tile at the picture's end has no real one behind it.
inline constexpr int kNodeMargin = sparse_kernels::kNodes - sparse_kernels::kBefore - 1;

/// Numbers at nodes and around them, as quintics go on there.
class NodePlane {
 public:
  explicit NodePlane(const SparseRays& sparse)
      : sparse_(sparse),
        width_(sparse.columns + 2 * kNodeMargin),
        values_(static_cast<std::size_t>(width_) *
                static_cast<std::size_t>(sparse.rows + 2 * kNodeMargin)) {}

  /// @param nodes  row by row
  void set(const float* nodes) {
    for (int row = 0; row < sparse_.rows; ++row) {
      std::copy_n(
          nodes + static_cast<std::ptrdiff_t>(row) * sparse_.columns,
          sparse_.columns,
          values_.data() + static_cast<std::ptrdiff_t>(row + kNodeMargin) * width_ + kNodeMargin);
    }
    for (const auto& [to, step, is_cubic] : sparse_.beyond) {
      float* at = values_.data() + to;
      const auto next = [&, by = step](int k) { return at[k * by]; };
      at[0] = is_cubic ? 4.0F * (next(1) + next(3)) - 6.0F * next(2) - next(4)
                       : 6.0F * (next(1) + next(5)) - 15.0F * (next(2) + next(4)) +
                             20.0F * next(3) - next(6);
    }
  }

  /// The first of `columns + 2 kNodeMargin`. @param index  from -kNodeMargin to rows + kNodeMargin
  /// - 1
  const float* row(int index) const {
    return values_.data() + static_cast<std::ptrdiff_t>(index + kNodeMargin) * width_;
  }

  /// The rows around tiles, from the first node that the first tile needs.
  sparse_kernels::NodeRows around(int tile_row) const {
    sparse_kernels::NodeRows rows;
    for (int i = 0; i < sparse_kernels::kNodes; ++i) {
      rows[static_cast<std::size_t>(i)] =
          row(tile_row + i - sparse_kernels::kBefore) + kNodeMargin - sparse_kernels::kBefore;
    }
    return rows;
  }

  /// Nodes of these rows that the tiles need.
  int width_around() const { return sparse_.columns + sparse_kernels::kNodes - 1; }

 private:
  const SparseRays& sparse_;
  int width_;
  std::vector<float> values_;
};

/// Short stretches: a call for each would take longer than to copy it.
inline void copy_stretch(const float* from, std::size_t count, float* to) {
  std::size_t done = 0;
  for (; done + sparse_kernels::kStep <= count; done += sparse_kernels::kStep) {
    std::memcpy(to + done, from + done, sparse_kernels::kStep * sizeof(float));
  }
  for (; done < count; ++done) {
    to[done] = from[done];
  }
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/refined_cells.h"

#include <cstring>
#include <numeric>
#include <span>

#include "simulator/render/footprint/lit_cells.h"
#include "simulator/render/footprint/pixel_dark.h"

namespace glint {

namespace {

std::size_t corners_of_pixel(const RefinedGroup& group) {
  const auto n = static_cast<std::size_t>(group.cells_per_axis);
  return (n + 1) * (n + 1);
}

}  // namespace

void RefinedCells::intersect(const RefinedGroup& group,
                             const Tunnel& tunnel,
                             std::size_t begin,
                             std::size_t end) {
  const std::size_t corners = corners_of_pixel(group);
  group_ = &group;
  begin_ = begin;
  intersect_light(group.rays,
                  tunnel,
                  static_cast<std::int64_t>(begin * corners),
                  static_cast<int>((end - begin) * corners),
                  hits_);
}

std::array<double, 2> RefinedCells::turn_to(std::size_t index) {
  const auto n = static_cast<std::size_t>(group_->cells_per_axis);
  const std::size_t corners = corners_of_pixel(*group_);
  const std::size_t first = (index - begin_) * corners;
  pixel_ = {.first = first,
            .weight = group_->rays.weight.data() + index * corners,
            .is_smooth = group_->is_smooth.data() + index * n * n,
            .cells_per_axis = group_->cells_per_axis};
  gain_.assign(pixel_.weight, pixel_.weight + corners);
  for (std::size_t i = 0; i < corners && !hits_.cosine.empty(); ++i) {
    gain_[i] *= hits_.cosine[first + i];
  }
  places_ = cut_kernels::find_limits(hits_.x_mm.data() + first,
                                     hits_.y_mm.data() + first,
                                     hits_.margin_mm.data() + first,
                                     pixel_.weight,
                                     static_cast<int>(corners));
  return {static_cast<double>(places_.x_low_mm), static_cast<double>(places_.x_high_mm)};
}

double RefinedCells::mean_dark(const DarkRadiance& dark) const {
  std::vector<std::size_t> rays(corners_of_pixel(*group_));
  std::iota(rays.begin(), rays.end(), pixel_.first);
  return glint::mean_dark(dark, hits_, pixel_.weight - pixel_.first, rays);
}

void RefinedCells::add_to(CellSum& sum) {
  const std::array<double, 2> x_mm = {static_cast<double>(places_.x_low_mm),
                                      static_cast<double>(places_.x_high_mm)};
  const std::array<double, 2> y_mm = {static_cast<double>(places_.y_low_mm),
                                      static_cast<double>(places_.y_high_mm)};
  if (x_mm[0] > x_mm[1]) {
    return;
  }
  const bool is_added =
      sum.is_lit_throughout(x_mm, y_mm, static_cast<double>(places_.margin_low_mm)) &&
      sum.add_lit_cells(cells(pixel_.is_smooth));
  if (!is_added) {
    add_smooth_cells(sum);
  }
  add_corners(sum, nullptr);
}

void RefinedCells::add_to(CellSum& sum, const VisiblePart& visible) {
  if (places_.x_low_mm > places_.x_high_mm) {
    return;
  }
  const int n = pixel_.cells_per_axis;
  const double side = 1.0 / n;
  for (int cell = 0; cell < n * n; ++cell) {
    if (pixel_.is_smooth[cell] == 0) {
      continue;
    }
    const int row = cell / n;
    const int column = cell % n;
    const std::vector<PixelPolygon> seen = visible.polygons(
        {.x = (column + 0.5) * side - 0.5, .y = (row + 0.5) * side - 0.5, .side = side});
    const std::size_t a = pixel_.first + static_cast<std::size_t>(row * (n + 1) + column);
    const std::size_t b = a + static_cast<std::size_t>(n) + 1;
    sum.add_visible(
        CellCorners(hits_, pixel_.weight - pixel_.first, {a, a + 1, b, b + 1}), side * side, seen);
  }
  add_corners(sum, &visible);
}

cut_kernels::CellGrid RefinedCells::cells(const unsigned char* is_wanted) const {
  return {.stripes_mm = hits_.stripes_mm().data() + pixel_.first,
          .gain = gain_.data(),
          .is_smooth = is_wanted,
          .cells_per_axis = pixel_.cells_per_axis};
}

/// Adds those of the smooth cells that are lit throughout. @return 1 for those that may be cut
const unsigned char* RefinedCells::find_cut_cells(CellSum& sum) {
  if (!positions_.is_even) {
    return pixel_.is_smooth;
  }
  const int n = pixel_.cells_per_axis;
  cut_kernels::sort_cells({.x_mm = hits_.x_mm.data() + pixel_.first,
                           .y_mm = hits_.y_mm.data() + pixel_.first,
                           .margin_mm = hits_.margin_mm.data() + pixel_.first},
                          pixel_.is_smooth,
                          n,
                          limits_,
                          is_lit_.data(),
                          is_cut_.data());
  const bool has_lit = std::memchr(is_lit_.data(), 1, static_cast<std::size_t>(n * n)) != nullptr;
  const bool is_added = !has_lit || sum.add_lit_cells(cells(is_lit_.data()));
  return is_added ? is_cut_.data() : pixel_.is_smooth;
}

/// Cells that lie on the light as a whole are summed as samples. Of the others those that one
/// straight boundary cuts are cut together, the rest one by one.
void RefinedCells::add_smooth_cells(CellSum& sum) {
  const int n = pixel_.cells_per_axis;
  const unsigned char* is_cut = find_cut_cells(sum);
  cell_corners_.clear();
  for (int cell = 0; cell < n * n; ++cell) {
    if (is_cut[cell] != 0) {
      cell_corners_.push_back(cell / n * (n + 1) + cell % n);
    }
  }
  const double share = 1.0 / (n * n);
  for (std::size_t begin = 0; begin < cell_corners_.size(); begin += cut_kernels::kBatch) {
    const auto corners = std::span(cell_corners_).subspan(begin);
    batch_.load(hits_, pixel_.weight, pixel_.first, n + 1, corners);
    if (positions_.is_even) {
      batch_.find_cuts(limits_);
      add_cut_cells(share, sum);
    }
    for (std::size_t i = 0; i < batch_.size(); ++i) {
      if (!batch_.is_simple(i)) {
        const std::size_t a = pixel_.first + static_cast<std::size_t>(corners[i]);
        const std::size_t b = a + static_cast<std::size_t>(n) + 1;
        sum.add_smooth(CellCorners(hits_, pixel_.weight - pixel_.first, {a, a + 1, b, b + 1}),
                       share);
      }
    }
  }
}

/// The simple ones among the cells of the batch.
void RefinedCells::add_cut_cells(double share, CellSum& sum) {
  const ScanPositions& p = sum.positions();
  batch_.cut(p);
  std::array<float, cut_kernels::kBatch> radiance = {};
  for (std::size_t k = 0; k < p.shift_periods.size(); ++k) {
    batch_.integrate(p, k, radiance.data());
    sum.add_radiance(k, share * static_cast<double>(batch_.sum_simple(radiance.data())));
  }
}

/// What cells that are not smooth leave to their corners, each for the square around it.
void RefinedCells::add_corners(CellSum& sum, const VisiblePart* visible) {
  const auto n = static_cast<std::size_t>(pixel_.cells_per_axis);
  if (std::memchr(pixel_.is_smooth, 0, n * n) == nullptr) {
    return;
  }
  static_assert(kCellCounts.back() <= cut_kernels::kMaxCells);
  weight_.resize(gain_.size());
  cut_kernels::corner_weights(pixel_.is_smooth, pixel_.cells_per_axis, weight_.data());
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    const float gain = weight_[i] * gain_[i];
    if (gain > 0.0F) {
      const std::size_t at = pixel_.first + i;
      const double side = 1.0 / static_cast<double>(n);
      const std::size_t row = i / (n + 1);
      const double seen = visible != nullptr
                              ? visible->area({.x = static_cast<double>(i % (n + 1)) * side - 0.5,
                                               .y = static_cast<double>(row) * side - 0.5,
                                               .side = side})
                              : 1.0;
      sum.add_place(static_cast<double>(hits_.x_mm[at]),
                    static_cast<double>(hits_.stripes_mm()[at]),
                    static_cast<double>(hits_.y_mm[at]),
                    static_cast<double>(hits_.margin_mm[at]),
                    seen * static_cast<double>(gain));
    }
  }
}

}  // namespace glint

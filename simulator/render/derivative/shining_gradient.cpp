// SPDX-License-Identifier: GPL-3.0-or-later
//
// The chain rule through T(w, D), pixel by pixel: w follows from the phase differences and these
// from the hits' x, D from the hits' y and margin. The derivatives are those of the cubics that the
// means come from. docs/theory/derivatives.md, "Table". Cost: some 0.3 us per pixel, most of it for
// the four hits' D. Memory: a row of floats.
#include "simulator/render/derivative/shining_gradient.h"

#include <algorithm>
#include <cstring>

#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/render/footprint/pixel_dark.h"

namespace glint {
namespace {

class ShiningRows {
 public:
  ShiningRows(const Footprints& footprints,
              const ScanPlan& plan,
              double variance,
              const std::vector<ShiningSum>& sums,
              ScanGradient& gradient)
      : footprints_(footprints),
        plan_(plan),
        sums_(sums),
        gradient_(gradient),
        corner_width_(static_cast<std::size_t>(footprints.rays().width_px) + 1),
        by_gx_(corner_width_ + 1),
        by_gy_(corner_width_ + 1) {
    const double per_period = 1.0 / footprints.positions().period_mm;
    scale_ = variance * per_period * per_period;
  }

  void add_row(int y, const float* by_aspect) {
    const int width = footprints_.rays().width_px;
    const unsigned char* by_table = plan_.by_table.row(y);
    if (std::memchr(by_table, 1, static_cast<std::size_t>(width)) == nullptr) {
      return;
    }
    gradient_.corners.open(static_cast<std::size_t>(y));
    gradient_.corners.open(static_cast<std::size_t>(y) + 1);
    std::ranges::fill(by_gx_, 0.0F);
    std::ranges::fill(by_gy_, 0.0F);
    for (int x = 0; x < width; ++x) {
      if (by_table[x] != 0 && by_aspect[x] != 0.0F) {
        const float factor = plan_.correction(x / kRippleTileWidth_px, y / kRippleTileHeight_px);
        add_pixel(x, y, static_cast<double>(factor * by_aspect[x]));
      }
    }
    float* top = gradient_.corners.x.data() + static_cast<std::size_t>(y) * corner_width_;
    gradient_kernels::add_gradients_to_corners(
        by_gx_.data() + 1, by_gy_.data() + 1, width, top, top + corner_width_);
  }

  double by_differences() const { return by_differences_; }

 private:
  void add_pixel(int x, int y, double weight) {
    const auto w = static_cast<double>(plan_.width(x, y));
    const DarkStencil stencil = ShiningMean::stencil_of(static_cast<double>(plan_.dark(x, y)));
    const ShiningMean& table = *plan_.shining;
    const ShiningMean::Value mean = table.value_of(table.means(), w, stencil);
    for (const ShiningSum& by : sums_) {
      *by.sum += weight * table.value_of(by.pieces, w, stencil).value;
    }
    add_mean_dark_gradient(
        footprints_.tunnel().dark(),
        footprints_.hits(),
        footprints_.rays().corners.weight.data(),
        footprints_.corners_of(y * footprints_.rays().width_px + x),
        weight * mean.by_dark,
        gradient_.dark_nodes,
        {.y = gradient_.corners.y.data(), .margin = gradient_.corners.margin.data()});
    if (w > 0.0) {
      add_differences(x, y, weight * mean.by_width * scale_ / w);
    }
  }

  /// w^2 goes with the sum of both squares.
  void add_differences(int x, int y, double factor) {
    const float* top = footprints_.hits().stripes_mm().data() +
                       static_cast<std::size_t>(y) * corner_width_ + static_cast<std::size_t>(x);
    const float* bottom = top + corner_width_;
    const auto gx = static_cast<double>(0.5F * ((top[1] + bottom[1]) - (top[0] + bottom[0])));
    const auto gy = static_cast<double>(0.5F * ((bottom[0] + bottom[1]) - (top[0] + top[1])));
    by_gx_[static_cast<std::size_t>(x) + 1] = static_cast<float>(factor * gx);
    by_gy_[static_cast<std::size_t>(x) + 1] = static_cast<float>(factor * gy);
    by_differences_ += factor * (gx * gx + gy * gy);
  }

  const Footprints& footprints_;
  const ScanPlan& plan_;
  const std::vector<ShiningSum>& sums_;
  ScanGradient& gradient_;
  std::size_t corner_width_;
  double scale_ = 0.0;                ///< w^2 for each square of a difference [1 / mm^2]
  std::vector<float> by_gx_, by_gy_;  ///< of a row, between two zeros
  double by_differences_ = 0.0;
};

}  // namespace

double add_shining_gradient(const Footprints& footprints,
                            const ScanPlan& plan,
                            const ImageF& by_aspect,
                            double variance,
                            const std::vector<ShiningSum>& sums,
                            ScanGradient& gradient) {
  ShiningRows rows(footprints, plan, variance, sums, gradient);
  for (int y = 0; y < by_aspect.height(); ++y) {
    rows.add_row(y, by_aspect.row(y));
  }
  return rows.by_differences();
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/derivative/cell_pixel_gradient.h"

#include <algorithm>
#include <numeric>

#include "simulator/render/footprint/pixel_dark.h"

namespace glint {

/// Rays of the pixel in work and where they meet the wall.
struct CellPixelGradient::Rays {
  const WallHits& hits;
  const float* weight = nullptr;
  std::span<const std::size_t> all;
};

/// Puts a cell's derivatives where they belong.
struct CellPixelGradient::CellAdder {
  GradientByHits& by_hits;
  std::size_t offset = 0;  ///< of the cell's corners in the arrays

  void operator()(const std::array<std::size_t, 4>& at, const CornerGradient& by) const {
    for (std::size_t c = 0; c < 4; ++c) {
      by_hits.x[offset + at[c]] += static_cast<float>(by.x[c]);
      by_hits.y[offset + at[c]] += static_cast<float>(by.y[c]);
      by_hits.margin[offset + at[c]] += static_cast<float>(by.margin[c]);
    }
  }
};

CellPixelGradient::CellPixelGradient(const Footprints& footprints,
                                     const Spans& pixels,
                                     double per_weight,
                                     ScanGradient& gradient)
    : footprints_(footprints),
      rays_(footprints.rays()),
      per_weight_(per_weight),
      gradient_(gradient),
      frames_(static_cast<std::size_t>(footprints.positions().frames())),
      positions_(footprints.positions()),
      cells_(positions_) {
  std::size_t place = 0;
  for (const RowSpan& span : pixels) {
    const Footprints::State* state = footprints_.state().row(span.y);
    for (int x = span.begin; x < span.end; ++x, ++place) {
      if (state[x] == Footprints::State::kCells) {
        cell_pixels_.push_back(span.y * rays_.width_px + x);
        places_.push_back(place);
      }
    }
  }
  cell_weights_.resize(cell_pixels_.size() * frames_);
}

void CellPixelGradient::add_frame(int frame, const std::vector<float>& by_radiance) {
  double* weights = cell_weights_.data() + frame;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    weights[i * frames_] = per_weight_ * static_cast<double>(by_radiance[places_[i]]);
  }
}

void CellPixelGradient::finish() {
  finish_cells();
  gradient_.duty += cells_.duty;
  gradient_.dark += positions_.is_dark_even ? cells_.dark : 0.0;
  gradient_.slot_mm += cells_.slot_mm;
  gradient_.period_mm += cells_.period_mm;
  gradient_.offset_mm += cells_.offset_mm;
}

void CellPixelGradient::finish_cells() {
  Image<std::int32_t> index_of;
  for (std::size_t i = 0; i < cell_pixels_.size(); ++i) {
    const auto pixel = static_cast<std::size_t>(cell_pixels_[i]);
    if (!load_weights(i)) {
      continue;
    }
    if (rays_.kind.values()[pixel] != PixelKind::kRefined) {
      add_unrefined(cell_pixels_[i]);
      continue;
    }
    if (index_of.empty()) {
      index_of = Image<std::int32_t>(rays_.width_px, rays_.height_px, -1);
    }
    index_of.values()[pixel] = static_cast<std::int32_t>(i);
  }
  for (std::size_t g = 0; !index_of.empty() && g < rays_.refined.size(); ++g) {
    const RefinedGroup& group = rays_.refined[g];
    for (std::size_t i = 0; i < group.pixels.size(); ++i) {
      const std::int32_t index = index_of.values()[static_cast<std::size_t>(group.pixels[i])];
      if (index >= 0) {
        add_refined(group, i, static_cast<std::size_t>(index), gradient_.refined[g]);
      }
    }
  }
}

void CellPixelGradient::add_unrefined(std::int32_t pixel) {
  const auto row = static_cast<std::size_t>(pixel / rays_.width_px);
  gradient_.corners.open(row);
  gradient_.corners.open(row + 1);
  const std::array<std::size_t, 4> corners = footprints_.corners_of(pixel);
  const Rays rays = {
      .hits = footprints_.hits(), .weight = rays_.corners.weight.data(), .all = corners};
  turn_to(pixel, rays);
  add_cell(rays, corners, {}, {gradient_.corners});
  finish_pixel(pixel, rays, {gradient_.corners});
}

void CellPixelGradient::add_refined(const RefinedGroup& group,
                                    std::size_t pixel,
                                    std::size_t index,
                                    RefinedGradient& gradient) {
  const auto n = static_cast<std::size_t>(group.cells_per_axis);
  const std::size_t first = pixel * (n + 1) * (n + 1);
  const std::size_t offset = gradient.pixels.size() * (n + 1) * (n + 1);
  GradientByHits& by_hits = gradient.by_hits;
  gradient.pixels.push_back(pixel);
  by_hits.resize(gradient.pixels.size(), (n + 1) * (n + 1));
  by_hits.open(gradient.pixels.size() - 1);
  intersect_light(group.rays,
                  footprints_.tunnel(),
                  static_cast<std::int64_t>(first),
                  static_cast<int>((n + 1) * (n + 1)),
                  hits_);
  load_weights(index);
  std::vector<std::size_t> corners((n + 1) * (n + 1));
  std::iota(corners.begin(), corners.end(), std::size_t{0});
  const Rays rays = {.hits = hits_, .weight = group.rays.weight.data() + first, .all = corners};
  turn_to(group.pixels[pixel], rays);
  const double side = 1.0 / static_cast<double>(n);
  for (std::size_t cell = 0; cell < n * n; ++cell) {
    if (group.is_smooth[pixel * n * n + cell] == 0) {
      cells_.has_detached = true;
      continue;
    }
    const std::size_t row = cell / n;
    const std::size_t at = row * (n + 1) + cell % n;
    add_cell(rays,
             {at, at + 1, at + n + 1, at + n + 2},
             {.x = (static_cast<double>(cell % n) + 0.5) * side - 0.5,
              .y = (static_cast<double>(row) + 0.5) * side - 0.5,
              .side = side},
             {by_hits, offset});
  }
  finish_pixel(group.pixels[pixel], rays, {by_hits, offset});
}

/// The pixel that cells are added of next.
void CellPixelGradient::turn_to(std::int32_t pixel, const Rays& rays) {
  const OccludedEdge* edge = footprints_.occluded_edge(pixel);
  visible_.reset();
  if (edge != nullptr) {
    visible_.emplace(*edge, footprints_.tunnel().settings());
  }
  if (!positions_.is_dark_even) {
    const double dark = mean_dark(footprints_.tunnel().dark(), rays.hits, rays.weight, rays.all);
    positions_.shine(footprints_.positions(), dark);
    dark_before_ = cells_.dark;
  }
}

/// @param square  that the cell is of the pixel
void CellPixelGradient::add_cell(const Rays& rays,
                                 const std::array<std::size_t, 4>& at,
                                 const SquareOfPixel& square,
                                 const CellAdder& add) {
  const CellCorners corners(rays.hits, rays.weight, at);
  if (visible_) {
    cells_.add_visible(corners, at, *visible_, square, weights_, add);
  } else {
    cells_.add_smooth(corners, at, square.side * square.side, weights_, add);
  }
}

void CellPixelGradient::finish_pixel(std::int32_t pixel, const Rays& rays, const CellAdder& add) {
  cells_.finish(weights_, add);
  gradient_.detached_pixels += cells_.has_detached ? 1 : 0;
  if (visible_) {
    add_edges(pixel);
  }
  if (!positions_.is_dark_even) {
    add_mean_dark_gradient(
        footprints_.tunnel().dark(),
        rays.hits,
        rays.weight,
        rays.all,
        cells_.dark - dark_before_,
        gradient_.dark_nodes,
        {.y = add.by_hits.y.data() + add.offset, .margin = add.by_hits.margin.data() + add.offset});
  }
}

/// The slot's edges are |y| = half of its width, the ends |x| = half of the length.
void CellPixelGradient::add_edges(std::int32_t pixel) {
  const auto& [rim, start, end, left, right] = cells_.by_edges;
  const auto difference = [](const LinearGradient& a, const LinearGradient& b) {
    return LinearGradient{.value = a.value - b.value, .dx = a.dx - b.dx, .dy = a.dy - b.dy};
  };
  const auto corners = [](const LinearGradient& by) {
    OccludedEdge::Corners floats = {};
    std::ranges::transform(
        by.by_corners(), floats.begin(), [](double value) { return static_cast<float>(value); });
    return floats;
  };
  gradient_.edges.push_back({.pixel = pixel,
                             .x = corners(difference(start, end)),
                             .y = corners(difference(left, right)),
                             .margin = corners(rim)});
  gradient_.slot_mm += 0.5 * (left.value + right.value);
  cells_.by_edges = {};
}

/// False when the pixel has no derivative.
bool CellPixelGradient::load_weights(std::size_t index) {
  weights_.assign(cell_weights_.begin() + static_cast<std::ptrdiff_t>(index * frames_),
                  cell_weights_.begin() + static_cast<std::ptrdiff_t>((index + 1) * frames_));
  cells_.has_detached = false;
  return std::ranges::any_of(weights_, [](double weight) { return weight != 0.0; });
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/physical/cell_sums.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace glint {
namespace {

/// A float picture's pixel plus a double.
void add(ImageF& image, int x, int y, double value) {
  image(x, y) = static_cast<float>(static_cast<double>(image(x, y)) + value);
}

}  // namespace

std::vector<Cell> cells_of(int width_px, int height_px) {
  std::vector<Cell> cells;
  for (int y = 0; y < height_px; y += kCellWidth_px) {
    for (int x = 0; x < width_px; x += kCellWidth_px) {
      cells.push_back({.x_px = x,
                       .y_px = y,
                       .width_px = std::min(kCellWidth_px, width_px - x),
                       .height_px = std::min(kCellWidth_px, height_px - y)});
    }
  }
  return cells;
}

CellSums::CellSums(std::vector<double> factors, int channels, std::vector<std::int32_t> ids)
    : factors_(std::move(factors)),
      channels_(static_cast<std::size_t>(channels)),
      ids_(std::move(ids)),
      light_(kCellPixels * factors_.size() * channels_),
      defects_(kCellPixels * ids_.size()) {}

void CellSums::clear() {
  std::ranges::fill(light_, 0.0);
  squares_.fill(0.0);
  surface_.fill({});
  std::ranges::fill(defects_, std::uint16_t{0});
  dropped_ = 0;
}

double CellSums::add_light(CellPixel pixel, int group, const Colour& radiance) {
  if (!(radiance >= 0.0).all() || !radiance.isFinite().all()) {
    ++dropped_;
    return 0.0;
  }
  const auto g = static_cast<std::size_t>(group);
  double* const to = light_.data() + (pixel * factors_.size() + g) * channels_;
  double sum = 0.0;
  for (std::size_t c = 0; c < channels_; ++c) {
    to[c] += radiance[static_cast<Eigen::Index>(c)];
    sum += radiance[static_cast<Eigen::Index>(c)];
  }
  return factors_[g] * sum / static_cast<double>(channels_);
}

void CellSums::add_square(CellPixel pixel, double total) {
  squares_[pixel] += total * total;
}

void CellSums::add_surface(CellPixel pixel,
                           const ShadingPoint& point,
                           const Ray& ray,
                           const Eigen::Vector3d& camera_axis,
                           std::int32_t triangle) {
  Surface& surface = surface_[pixel];
  ++surface.samples;
  surface.depth_mm += camera_axis.dot(point.point_mm - ray.origin_mm);
  surface.tilt += 1.0 - std::min(1.0, point.to_viewer.z);
  surface.normal += point.frame.normal;
  surface.point_mm += point.point_mm;
  surface.triangle = surface.triangle < 0 ? triangle : surface.triangle;
  const auto id = std::ranges::lower_bound(ids_, point.defect);
  if (id != ids_.end() && *id == point.defect) {
    surface.defect = surface.defect < 0 ? point.defect : surface.defect;
    ++defects_[pixel * ids_.size() + static_cast<std::size_t>(id - ids_.begin())];
  }
}

void CellSums::add_to(const Cell& cell, int samples, PathSums& sums) const {
  for (int y = 0; y < cell.height_px; ++y) {
    for (int x = 0; x < cell.width_px; ++x) {
      sums.samples(cell.x_px + x, cell.y_px + y) += samples;
      add_pixel(static_cast<CellPixel>(kCellWidth_px * y + x), cell.x_px + x, cell.y_px + y, sums);
    }
  }
}

void CellSums::add_pixel(CellPixel from, int x, int y, PathSums& sums) const {
  const double* light = light_.data() + from * factors_.size() * channels_;
  for (GroupSums& group : sums.groups) {
    for (ImageF& channel : group.channels) {
      add(channel, x, y, *light++);
    }
  }
  add(sums.squares, x, y, squares_[from]);
  const Surface& surface = surface_[from];
  if (surface.samples == 0) {
    return;
  }
  sums.part(x, y) += surface.samples;
  add(sums.depth_mm, x, y, surface.depth_mm);
  add(sums.normal_x, x, y, surface.normal.x());
  add(sums.normal_y, x, y, surface.normal.y());
  add(sums.normal_z, x, y, surface.normal.z());
  add(sums.x_mm, x, y, surface.point_mm.x());
  add(sums.y_mm, x, y, surface.point_mm.y());
  add(sums.z_mm, x, y, surface.point_mm.z());
  add(sums.tilt, x, y, surface.tilt);
  std::int32_t& triangle = sums.triangle(x, y);
  triangle = triangle < 0 ? surface.triangle : triangle;
  std::int32_t& defect = sums.defect(x, y);
  defect = defect < 0 ? surface.defect : defect;
  for (std::size_t i = 0; i < sums.defects.size(); ++i) {
    std::uint16_t& count = sums.defects[i].samples(x, y);
    count = static_cast<std::uint16_t>(count + defects_[from * ids_.size() + i]);
  }
}

PathSums empty_sums(
    int width_px, int height_px, std::size_t groups, int channels, std::vector<std::int32_t> ids) {
  const ImageF zero(width_px, height_px);
  PathSums sums;
  sums.width_px = width_px;
  sums.height_px = height_px;
  sums.samples = Image<std::int32_t>(width_px, height_px);
  sums.groups.resize(groups);
  for (GroupSums& group : sums.groups) {
    group.channels.assign(static_cast<std::size_t>(channels), zero);
  }
  for (ImageF* image : {&sums.squares,
                        &sums.depth_mm,
                        &sums.normal_x,
                        &sums.normal_y,
                        &sums.normal_z,
                        &sums.x_mm,
                        &sums.y_mm,
                        &sums.z_mm,
                        &sums.tilt}) {
    *image = zero;
  }
  sums.part = Image<std::int32_t>(width_px, height_px);
  sums.triangle = Image<std::int32_t>(width_px, height_px, -1);
  sums.defect = Image<std::int32_t>(width_px, height_px, -1);
  for (const std::int32_t id : ids) {
    sums.defects.push_back({.id = id, .samples = Image<std::uint16_t>(width_px, height_px)});
  }
  return sums;
}

}  // namespace glint

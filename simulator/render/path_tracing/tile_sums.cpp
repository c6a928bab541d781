// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sums of a tile lie plane by plane, 64 doubles each, in the cache of the core that renders it, and
// go into the picture once a pass: threads share nothing in between, and the order of the additions
// to a pixel is that of its own samples whatever the number of threads. Cost: one addition a plane
// and sample. docs/theory/path_tracing.md, docs/decisions/0002-bit-identical-results.md.
#include "simulator/render/path_tracing/tile_sums.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace glint {
namespace {

/// Adds a tile's numbers to a picture.
template <class Pixel, class Number>
void add_plane(const Tile& tile,
               const std::array<Number, kTilePixels>& plane,
               Image<Pixel>& image) {
  for (int y = 0; y < tile.height_px; ++y) {
    const Number* const from = plane.data() + kTileWidth_px * y;
    Pixel* const to = &image(tile.x_px, tile.y_px + y);
    for (int x = 0; x < tile.width_px; ++x) {
      to[x] = static_cast<Pixel>(static_cast<Number>(to[x]) + from[x]);
    }
  }
}

}  // namespace

std::vector<Tile> tiles_of(int width_px, int height_px) {
  std::vector<Tile> tiles;
  for (int y = 0; y < height_px; y += kTileWidth_px) {
    for (int x = 0; x < width_px; x += kTileWidth_px) {
      tiles.push_back({.x_px = x,
                       .y_px = y,
                       .width_px = std::min(kTileWidth_px, width_px - x),
                       .height_px = std::min(kTileWidth_px, height_px - y)});
    }
  }
  return tiles;
}

TileSums::TileSums(std::vector<double> factors, int channels, std::vector<std::int32_t> ids)
    : factors_(std::move(factors)),
      channels_(static_cast<std::size_t>(channels)),
      ids_(std::move(ids)),
      light_(factors_.size() * channels_),
      defects_(kTilePixels * ids_.size()) {}

void TileSums::clear() {
  std::ranges::fill(light_, Plane{});
  squares_.fill(0.0);
  surface_ = {};
  surface_.triangle.fill(-1);
  surface_.defect.fill(-1);
  std::ranges::fill(defects_, std::uint16_t{0});
  dropped_ = 0;
}

double TileSums::add_light(TilePixel pixel, int group, const std::array<float, 3>& radiance) {
  constexpr float kMax = std::numeric_limits<float>::max();
  const auto is_good = [](float value) { return value >= 0.0F && value <= kMax; };
  if (!is_good(radiance[0]) || !is_good(radiance[1]) || !is_good(radiance[2])) {
    ++dropped_;
    return 0.0;
  }
  const auto g = static_cast<std::size_t>(group);
  double sum = 0.0;
  for (std::size_t c = 0; c < channels_; ++c) {
    const auto value = static_cast<double>(radiance[c]);
    light_[g * channels_ + c][pixel] += value;
    sum += value;
  }
  return factors_[g] * sum / static_cast<double>(channels_);
}

void TileSums::add_square(TilePixel pixel, double total) {
  squares_[pixel] += total * total;
}

void TileSums::add_surface(TilePixel pixel,
                           const SurfaceLanes& surface,
                           const PathPacket& paths,
                           const Eigen::Vector3d& camera_axis,
                           std::size_t lane) {
  const Eigen::Vector3d point_mm(static_cast<double>(surface.point.x[lane]),
                                 static_cast<double>(surface.point.y[lane]),
                                 static_cast<double>(surface.point.z[lane]));
  const Eigen::Vector3d origin_mm(static_cast<double>(paths.ray.origin_x[lane]),
                                  static_cast<double>(paths.ray.origin_y[lane]),
                                  static_cast<double>(paths.ray.origin_z[lane]));
  Surface& sum = surface_;
  ++sum.samples[pixel];
  sum.depth_mm[pixel] += camera_axis.dot(point_mm - origin_mm);
  sum.tilt[pixel] += static_cast<double>(surface.tilt[lane]);
  sum.normal_x[pixel] += static_cast<double>(surface.normal.x[lane]);
  sum.normal_y[pixel] += static_cast<double>(surface.normal.y[lane]);
  sum.normal_z[pixel] += static_cast<double>(surface.normal.z[lane]);
  sum.x_mm[pixel] += point_mm.x();
  sum.y_mm[pixel] += point_mm.y();
  sum.z_mm[pixel] += point_mm.z();
  std::int32_t& triangle = sum.triangle[pixel];
  triangle = triangle < 0 ? paths.hit.triangle[lane] : triangle;
  const std::int32_t defect = surface.defect[lane];
  if (defect < 0) {
    return;
  }
  const auto id = std::ranges::lower_bound(ids_, defect);
  if (id != ids_.end() && *id == defect) {
    sum.defect[pixel] = sum.defect[pixel] < 0 ? defect : sum.defect[pixel];
    ++defects_[pixel * ids_.size() + static_cast<std::size_t>(id - ids_.begin())];
  }
}

void TileSums::add_to(const Tile& tile, int samples, Film& sums) const {
  for (int y = 0; y < tile.height_px; ++y) {
    for (int x = 0; x < tile.width_px; ++x) {
      sums.samples(tile.x_px + x, tile.y_px + y) += samples;
    }
  }
  auto light = light_.begin();
  for (GroupSums& group : sums.groups) {
    for (ImageF& channel : group.channels) {
      add_plane(tile, *light++, channel);
    }
  }
  add_plane(tile, squares_, sums.squares);
  if (std::ranges::all_of(surface_.samples, [](std::int32_t n) { return n == 0; })) {
    return;
  }
  add_plane(tile, surface_.samples, sums.part);
  add_plane(tile, surface_.depth_mm, sums.depth_mm);
  add_plane(tile, surface_.normal_x, sums.normal_x);
  add_plane(tile, surface_.normal_y, sums.normal_y);
  add_plane(tile, surface_.normal_z, sums.normal_z);
  add_plane(tile, surface_.x_mm, sums.x_mm);
  add_plane(tile, surface_.y_mm, sums.y_mm);
  add_plane(tile, surface_.z_mm, sums.z_mm);
  add_plane(tile, surface_.tilt, sums.tilt);
  add_ids(tile, sums);
}

/// Which triangles and defects were met, and how often.
void TileSums::add_ids(const Tile& tile, Film& sums) const {
  for (int y = 0; y < tile.height_px; ++y) {
    for (int x = 0; x < tile.width_px; ++x) {
      const auto pixel = static_cast<std::size_t>(kTileWidth_px * y + x);
      std::int32_t& triangle = sums.triangle(tile.x_px + x, tile.y_px + y);
      triangle = triangle < 0 ? surface_.triangle[pixel] : triangle;
      std::int32_t& defect = sums.defect(tile.x_px + x, tile.y_px + y);
      defect = defect < 0 ? surface_.defect[pixel] : defect;
      for (std::size_t i = 0; i < sums.defects.size(); ++i) {
        std::uint16_t& count = sums.defects[i].samples(tile.x_px + x, tile.y_px + y);
        count = static_cast<std::uint16_t>(count + defects_[pixel * ids_.size() + i]);
      }
    }
  }
}

Film empty_film(
    int width_px, int height_px, std::size_t groups, int channels, std::vector<std::int32_t> ids) {
  const ImageF zero(width_px, height_px);
  Film sums;
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/sampled/sampled_squares.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/image/spans.h"
#include "simulator/render/path_tracing/tile_sums.h"
#include "simulator/sensor/sensor.h"
#include "studies/definition/render_methods.h"
#include "studies/imaging/frame_exposure.h"
#include "studies/imaging/path_picture.h"

namespace glint {
namespace {

constexpr int kSide_px = kTileWidth_px;  ///< of a square

Sensor sensor_of(const SceneSettings& scene) {
  return {scene.sensor, scene.camera.width_px, scene.camera.height_px};
}

/// The squares that a picture consists of; those at its border are cut.
///
/// Under a blur they lie half a tile beside the tiles that paths are followed in, so that four
/// tiles hold a square and half a tile around it.
class SquareGrid {
 public:
  SquareGrid(const CameraSettings& camera, int blur_radius_px)
      : width_px_(camera.width_px),
        height_px_(camera.height_px),
        offset_px_(blur_radius_px > 0 ? kSide_px / 2 : 0) {}

  int size() const { return columns() * squares_along(height_px_); }

  PixelWindow square(int index) const {
    const int x = kSide_px * (index % columns()) - offset_px_;
    const int y = kSide_px * (index / columns()) - offset_px_;
    return within({.left_px = x, .top_px = y, .width_px = kSide_px, .height_px = kSide_px});
  }

  /// The square and so much around it. @param window  of square()
  PixelWindow around(const PixelWindow& window, int margin_px) const {
    return within({.left_px = window.left_px - margin_px,
                   .top_px = window.top_px - margin_px,
                   .width_px = window.width_px + 2 * margin_px,
                   .height_px = window.height_px + 2 * margin_px});
  }

 private:
  int squares_along(int pixels) const { return (pixels + offset_px_ + kSide_px - 1) / kSide_px; }

  int columns() const { return squares_along(width_px_); }

  /// What of it is in the picture.
  PixelWindow within(const PixelWindow& window) const {
    const int left = std::max(0, window.left_px);
    const int top = std::max(0, window.top_px);
    const int right = std::min(width_px_, window.left_px + window.width_px);
    const int bottom = std::min(height_px_, window.top_px + window.height_px);
    return {.left_px = left, .top_px = top, .width_px = right - left, .height_px = bottom - top};
  }

  int width_px_;
  int height_px_;
  int offset_px_;
};

template <class Use>
void for_each_pixel_of(const PixelWindow& window, const Use& use) {
  for (int y = window.top_px; y < window.top_px + window.height_px; ++y) {
    for (int x = window.left_px; x < window.left_px + window.width_px; ++x) {
      use(x, y);
    }
  }
}

bool has_pixel_of(const Mask& region, const PixelWindow& window) {
  bool has_one = false;
  for_each_pixel_of(window, [&](int x, int y) { has_one = has_one || region(x, y) != 0; });
  return has_one;
}

/// Squares with pixels of the region, in the order in which they were drawn. Empty: there are less
/// than twice as many as are wanted.
std::vector<PixelWindow> drawn_squares(const SquareGrid& grid, const Mask& region, Rng& rng) {
  std::vector<PixelWindow> squares;
  for (int i = 0; i < grid.size(); ++i) {
    const PixelWindow square = grid.square(i);
    if (has_pixel_of(region, square)) {
      squares.push_back(square);
    }
  }
  constexpr std::size_t kWanted = kSampledSquares;
  if (squares.size() < 2 * kWanted) {
    return {};
  }
  for (std::size_t i = 0; i < kWanted; ++i) {
    const auto left = static_cast<double>(squares.size() - i);
    const auto taken = i + static_cast<std::size_t>(rng.uniform() * left);
    std::swap(squares[i], squares[taken]);
  }
  squares.resize(kWanted);
  return squares;
}

Spans spans_in(std::span<const PixelWindow> windows, const CameraSettings& camera) {
  Mask inside(camera.width_px, camera.height_px);
  for (const PixelWindow& window : windows) {
    for_each_pixel_of(window, [&](int x, int y) { inside(x, y) = 1; });
  }
  return spans_of(inside);
}

/// The mean of the frames, right in the squares alone.
ImageF aspect_in(SceneStore& store,
                 const SceneSettings& scene,
                 const SquareGrid& grid,
                 const std::vector<PixelWindow>& squares) {
  const PathView view(scene, store.build_defects(scene), scene.viewpoint());
  const Sensor sensor = sensor_of(scene);
  std::vector<PixelWindow> lit;
  for (const PixelWindow& square : squares) {
    lit.push_back(grid.around(square, sensor.blur_radius_px()));
  }
  const PathPicture picture = render_view(view, path_settings(scene), store.pool(), lit);
  const Spans seen = spans_in(squares, scene.camera);
  const Spans around = spans_in(lit, scene.camera);
  ScanSums sums;
  for (std::size_t k = 0; k < view.frames().size(); ++k) {
    const std::vector<ImageF> radiance = channel_radiances(picture, view.frames()[k], {}, around);
    accumulate_channels(sensor, radiance, static_cast<int>(k), sums, nullptr, seen);
  }
  return sums.aspect();
}

/// Whether a pixel of its picture needs no more of it than the blur spreads into it.
bool has_independent_pixels(const SceneSettings& scene) {
  return needs_paths(scene) && !is_direct(scene) && is_lit(scene) && scene.paths.has_light &&
         scene.expose_to <= 0.0 && scene.paths.relative_error <= 0.0;
}

}  // namespace

double share_of_squares(const SceneSettings& scene) {
  const int radius = sensor_of(scene).blur_radius_px();
  const int tiles_beside = (kSide_px / 2 + radius + kSide_px - 1) / kSide_px;
  const int side = radius > 0 ? 2 * tiles_beside * kSide_px : kSide_px;
  const double pixels = static_cast<double>(scene.camera.width_px) * scene.camera.height_px;
  return kSampledSquares * static_cast<double>(side) * side / pixels;
}

std::optional<std::vector<SampledSquare>> sampled_squares(SceneStore& store,
                                                          const SceneSettings& cheap,
                                                          const SceneSettings& dearer,
                                                          Rng rng) {
  const bool is_same_picture = cheap.camera.width_px == dearer.camera.width_px &&
                               cheap.camera.height_px == dearer.camera.height_px;
  if (!is_same_picture || !has_independent_pixels(cheap) || !has_independent_pixels(dearer)) {
    return std::nullopt;
  }
  const SceneSettings first = first_view(store, cheap);
  const std::shared_ptr<const TracedScene> traced = store.trace(first);
  const Mask& region = traced->region.mask;
  const SquareGrid grid(first.camera, sensor_of(first).blur_radius_px());
  const std::vector<PixelWindow> squares = drawn_squares(grid, region, rng);
  if (squares.empty()) {
    return std::nullopt;
  }
  const ImageF coarse = aspect_in(store, first, grid, squares);
  const ImageF fine = aspect_in(store, first_view(store, dearer), grid, squares);
  std::vector<SampledSquare> sampled(squares.size());
  for (std::size_t i = 0; i < squares.size(); ++i) {
    for_each_pixel_of(squares[i], [&](int x, int y) {
      if (region(x, y) != 0) {
        sampled[i].push_back({.cheap = static_cast<double>(coarse(x, y)),
                              .dearer = static_cast<double>(fine(x, y))});
      }
    });
  }
  return sampled;
}

}  // namespace glint
